// SPDX-License-Identifier: Apache-2.0
#include "master/console/connection_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace telekerf::master {
namespace {

using boost::asio::ip::address;

address plain(const address& from) {
  if (!from.is_v6() || !from.to_v6().is_v4_mapped()) return from;
  return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, from.to_v6());
}

/// One computer may use as many addresses of its network as it likes.
std::string owner_of(const address& from) {
  const address one = plain(from);
  if (one.is_v4() || one.is_loopback()) return one.to_string();
  auto bytes = one.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return boost::asio::ip::address_v6(bytes).to_string() + "/64";
}

}  // namespace

void ConnectionLimits::wait(const std::string& why) {
  ++waits_;
  if (std::exchange(waiting_, true)) return;
  waits_for_ = fmt::format(
      "browsers that want to connect have to wait: {}; close pages, or let this process open more files (LimitNOFILE "
      "of its service, ulimit -n)",
      why);
}

bool ConnectionLimits::admit(const address& from) {
  waiting_ = false;
  const std::string owner = owner_of(from);
  const bool other = !plain(from).is_loopback();
  const auto found = of_.find(owner);
  const int has = found == of_.end() ? 0 : found->second;
  std::string why;
  if (has >= kMostOfOne)
    why = fmt::format("{} of {} are open, as many as one computer may have", has, owner);
  else if (other && others_ >= kMostOfOthers)
    why = fmt::format("{} of other computers are open, as many as all of them may have", others_);
  else if (open_ >= kMost)
    why = fmt::format("{} are open, as many as may be", open_);
  if (!why.empty()) {
    ++refused_;
    last_ = fmt::format("one of {}: {}", owner, why);
    return false;
  }
  ++of_[owner];
  ++open_;
  if (other) ++others_;
  return true;
}

void ConnectionLimits::leave(const address& from) {
  const auto found = of_.find(owner_of(from));
  if (found == of_.end()) return;
  if (--found->second == 0) of_.erase(found);
  --open_;
  if (!plain(from).is_loopback()) --others_;
}

std::string ConnectionLimits::due(std::int64_t now_ns) {
  if (!waits_for_.empty() && (wait_said_ns_ == 0 || now_ns - wait_said_ns_ >= kAgain_ns)) {
    wait_said_ns_ = now_ns;
    return std::exchange(waits_for_, {});
  }
  if (refused_ == said_ || (said_ns_ != 0 && now_ns - said_ns_ < kAgain_ns)) return {};
  said_ns_ = now_ns;
  const std::uint64_t count = refused_ - said_;
  said_ = refused_;
  return fmt::format("{} {} refused, the last {}; close pages there", count,
                     count == 1 ? "connection of a browser was" : "connections of browsers were", last_);
}

}  // namespace telekerf::master
