// SPDX-License-Identifier: Apache-2.0
// How many connections the server bears, and of whom: one computer does not lock the others out, and others never this
// one.
#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstdint>
#include <map>
#include <string>

namespace telekerf::master {

/// Pure: time is what it is told.
class ConnectionLimits {
 public:
  static constexpr int kMost = 64;
  static constexpr int kMostOfOne = 24;                 ///< of one address; of IPv6 of one network of 64 bits
  static constexpr int kMostOfOthers = kMost - kMostOfOne;  ///< of all other computers together
  static constexpr std::int64_t kAgain_ns = 10'000'000'000;

  /// False: refused, and counted. Who was admitted has to leave.
  bool admit(const boost::asio::ip::address& from);
  void leave(const boost::asio::ip::address& from);
  /// A connection could not be taken, and waits: `why`, as the operating system says it.
  void wait(const std::string& why);
  /// One sentence of those that were refused, or wait, since the last one, every kAgain_ns at most; mostly empty.
  std::string due(std::int64_t now_ns);

  int open() const noexcept { return open_; }
  std::uint64_t refused() const noexcept { return refused_; }
  std::uint64_t waits() const noexcept { return waits_; }

 private:
  std::map<std::string, int> of_;  ///< by address
  int open_ = 0;
  int others_ = 0;  ///< of other computers
  std::uint64_t refused_ = 0;
  std::uint64_t said_ = 0;  ///< of these
  std::int64_t said_ns_ = 0;
  std::string last_;  ///< who was refused, and why
  std::uint64_t waits_ = 0;
  bool waiting_ = false;   ///< and none was taken since
  std::string waits_for_;  ///< what is to be said of that
  std::int64_t wait_said_ns_ = 0;
};

}  // namespace telekerf::master
