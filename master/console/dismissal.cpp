// SPDX-License-Identifier: Apache-2.0
#include "master/console/dismissal.h"

#include <array>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <string_view>
#include <utility>

namespace telekerf::master {
namespace {

constexpr std::string_view kFull =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: 62\r\n"
    "Connection: close\r\n\r\nToo many connections of this computer or of all; close a page\n";
constexpr std::chrono::seconds kFarewell{1};

/// Closed with its question unread it would not get to read the answer.
struct Leaving {
  boost::beast::tcp_stream line;
  std::array<char, 512> rest{};
};

}  // namespace

void Dismissal::say(boost::asio::ip::tcp::socket socket) {
  boost::system::error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(boost::asio::buffer(kFull.data(), kFull.size()), ignored);
  socket.shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  if (*leaving_ >= kMost) return;
  const auto one = std::make_shared<Leaving>(Leaving{boost::beast::tcp_stream(std::move(socket))});
  ++*leaving_;
  one->line.expires_after(kFarewell);
  one->line.async_read_some(boost::asio::buffer(one->rest),
                            [one, count = leaving_](boost::system::error_code, std::size_t) { --*count; });
}

}  // namespace telekerf::master
