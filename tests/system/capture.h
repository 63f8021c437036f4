// SPDX-License-Identifier: Apache-2.0
// What crosses a network interface, frame by frame as the kernel sees it, counted by what it carries.
#pragma once

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/overhead.h"
#include "common/protocol/site.h"

namespace telekerf::integration {

/// One kind of traffic. Bytes are those of whole Ethernet frames, with the 4 of the check sequence, which the
/// kernel does not show.
struct Traffic {
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;
  double mean() const { return frames == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(frames); }
};

struct Counted {
  Traffic commands, states, others;
  std::uint64_t copies = 0;      ///< samples of a stream that had been seen before
  std::uint64_t miscounted = 0;  ///< that cost something else than overhead.h says
  double seconds = 0.0;
  double bytes_per_s(const Traffic& traffic) const { return static_cast<double>(traffic.bytes) / seconds; }
};

/// Needs CAP_NET_RAW in this network namespace.
class Capture {
 public:
  explicit Capture(const std::string& interface)
      : fd_(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL))) {
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_ALL);
    address.sll_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    const int bytes = 8 << 20;
    (void)::setsockopt(fd_, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes);
    const timeval patience{0, 50'000};
    (void)::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    is_open_ = fd_ >= 0 && ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Capture() {
    if (fd_ >= 0) ::close(fd_);
  }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  bool is_open() const { return is_open_; }

  /// What has queued up since the last call is not counted.
  Counted count(std::chrono::milliseconds duration) {
    std::array<std::uint8_t, 65536> frame{};
    while (::recv(fd_, frame.data(), frame.size(), MSG_DONTWAIT) > 0) {
    }
    const auto begin = std::chrono::steady_clock::now();
    Counted counted;
    while (std::chrono::steady_clock::now() - begin < duration) {
      const auto size = ::recv(fd_, frame.data(), frame.size(), 0);
      if (size > 0) add(std::span(frame).first(static_cast<std::size_t>(size)), counted);
    }
    counted.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return counted;
  }

 private:
  static constexpr std::size_t kFrameHeads = 14 + 20 + 8;
  static constexpr std::uint64_t kCheckSequence = 4;

  void add(std::span<const std::uint8_t> frame, Counted& counted) {
    Traffic* traffic = &counted.others;
    if (const auto data = stream_data(frame); !data.empty()) {
      const bool command = (data[14] & 0xf0U) == 0x10U;
      traffic = command ? &counted.commands : &counted.states;
      // Writer of whom, and which of its samples.
      std::vector<std::uint8_t> key(frame.begin() + kFrameHeads + 8, frame.begin() + kFrameHeads + 20);
      key.insert(key.end(), data.begin() + 12, data.begin() + 24);
      if (++seen_[key] > 1) ++counted.copies;
      // The sample: encapsulation, number of octets, octets.
      const std::size_t octets = data[28] | std::size_t{data[29]} << 8;
      if (frame.size() + kCheckSequence != kDatagramBytes + sample_bytes(octets)) ++counted.miscounted;
    }
    ++traffic->frames;
    traffic->bytes += frame.size() + kCheckSequence;
  }

  /// The DATA submessage of a stream's sample; empty: the frame has none.
  static std::span<const std::uint8_t> stream_data(std::span<const std::uint8_t> frame) {
    if (frame.size() < kFrameHeads + 20 || frame[12] != 0x08 || frame[13] != 0x00 ||
        std::memcmp(&frame[kFrameHeads], "RTPS", 4) != 0)
      return {};
    for (std::size_t at = kFrameHeads + 20; at + 32 <= frame.size();) {
      const std::size_t length = frame[at + 2] | std::size_t{frame[at + 3]} << 8;
      const std::size_t end = length == 0 ? frame.size() : at + 4 + length;
      if (end > frame.size()) return {};
      if (frame[at] == 0x15 && frame[at + 12] == 0 && frame[at + 13] == kStreamEntity)
        return frame.subspan(at, end - at);
      at = end;
    }
    return {};
  }

  int fd_;
  bool is_open_ = false;
  std::map<std::vector<std::uint8_t>, int> seen_;
};

}  // namespace telekerf::integration
