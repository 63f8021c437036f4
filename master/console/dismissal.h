// SPDX-License-Identifier: Apache-2.0
// What a connection is told that may not be, as there are too many.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>

namespace telekerf::master {

class Dismissal {
 public:
  /// An answer of HTTP, as far as the line takes it at once, and a moment to read it for a few of them: who is refused
  /// costs nothing.
  void say(boost::asio::ip::tcp::socket socket);

 private:
  static constexpr int kMost = 16;
  std::shared_ptr<int> leaving_ = std::make_shared<int>(0);
};

}  // namespace telekerf::master
