// SPDX-License-Identifier: Apache-2.0
#include "common/bus/reunion.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/bus/rtps_message.h"

namespace telekerf::bus {
namespace {

using middleware::rtps::IPLocator;
using middleware::rtps::Locator_t;

/// Participants of a cell's few identities: more are somebody's mischief.
constexpr std::size_t kMost = 256;

class Bytes {
 public:
  Bytes& octets(std::initializer_list<std::uint8_t> values) {
    for (const std::uint8_t value : values) bytes_.push_back(std::byte{value});
    return *this;
  }
  template <class Range>
  Bytes& all(const Range& values) {
    for (const auto value : values) bytes_.push_back(static_cast<std::byte>(value));
    return *this;
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

std::vector<std::byte> farewell(const std::array<std::uint8_t, 12>& own,
                                const std::array<std::uint8_t, 12>& to) {
  constexpr std::uint8_t kParticipant[] = {0, 0, 1, 0xc1}, kWriter[] = {0, 1, 0, 0xc2},
                         kReader[] = {0, 1, 0, 0xc7};
  Bytes bytes;
  bytes.octets({'R', 'T', 'P', 'S', 2, 3, 0x01, 0x0f}).all(own);
  bytes.octets({0x0e, 0x01, 12, 0}).all(to);  // INFO_DST
  // DATA number 1 with inline QoS and without a payload: 20 octets, and the three parameters.
  bytes.octets({0x15, 0x03, 20 + 20 + 8 + 4, 0, 0, 0, 16, 0}).all(kReader).all(kWriter);
  bytes.octets({0, 0, 0, 0, 1, 0, 0, 0});
  bytes.octets({0x70, 0, 16, 0}).all(own).all(kParticipant);  // PID_KEY_HASH
  bytes.octets({0x71, 0, 4, 0, 0, 0, 0, 3});                  // PID_STATUS_INFO: disposed, unregistered
  bytes.octets({1, 0, 0, 0});                                 // PID_SENTINEL
  return bytes.take();
}

void send_datagram(std::span<const std::byte> datagram, const std::vector<Locator_t>& places) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  for (const Locator_t& place : places) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(IPLocator::getPhysicalPort(place));
    std::memcpy(&address.sin_addr, IPLocator::getIPv4(place), sizeof address.sin_addr);
    (void)::sendto(fd, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                   reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  (void)::close(fd);
}

void Unproven::found(const Key& key, Places places, Time now) {
  if (proved_.contains(key) || waiting_.size() >= kMost) return;
  const auto patience = lapsed_.contains(key) ? kKnownBefore : kNew;
  Entry& entry = waiting_.try_emplace(key, Entry{{}, now + patience, patience, {}}).first->second;
  entry.places = std::move(places);
  entry.refused.reset();
}

void Unproven::refused(const Key& key, Time now) {
  auto known = waiting_.find(key);
  if (known == waiting_.end()) {
    found(key, {}, now);
    known = waiting_.find(key);
    if (known == waiting_.end()) return;
  } else if (!known->second.refused) {
    return;
  }
  known->second.refused = now;
}

void Unproven::proved(const Key& key) {
  waiting_.erase(key);
  lapsed_.erase(key);
  if (proved_.size() < kMost) proved_.insert(key);
}

void Unproven::gone(const Key& key, bool lapsed) {
  waiting_.erase(key);
  const bool known = proved_.erase(key) > 0;
  if (lapsed && known && lapsed_.size() < kMost) lapsed_.insert(key);
}

std::vector<Unproven::Waiting> Unproven::due(Time now) {
  std::erase_if(waiting_, [&](const auto& waiting) {
    return waiting.second.refused && now - *waiting.second.refused > kForgotten;
  });
  std::vector<Waiting> list;
  for (auto& [key, entry] : waiting_) {
    if (now < entry.next) continue;
    list.push_back({key, entry.places});
    entry.patience = std::max(2 * entry.patience, kAgain);
    entry.next = now + entry.patience;
  }
  return list;
}

Reunion::Reunion(Again again)
    : again_(std::move(again)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void Reunion::found(const Unproven::Key& key, Unproven::Places places) {
  {
    const std::lock_guard lock(mutex_);
    unproven_.found(key, std::move(places), std::chrono::steady_clock::now());
  }
  changed_.notify_one();
}

void Reunion::refused(const Unproven::Key& key) {
  {
    const std::lock_guard lock(mutex_);
    unproven_.refused(key, std::chrono::steady_clock::now());
  }
  changed_.notify_one();
}

void Reunion::proved(const Unproven::Key& key) {
  const std::lock_guard lock(mutex_);
  unproven_.proved(key);
}

void Reunion::gone(const Unproven::Key& key, bool lapsed) {
  const std::lock_guard lock(mutex_);
  unproven_.gone(key, lapsed);
}

void Reunion::clear() {
  const std::lock_guard lock(mutex_);
  unproven_ = {};
}

void Reunion::run(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kNap{100};
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested() && changed_.wait(lock, stop, [this] { return !unproven_.empty(); })) {
    const auto due = unproven_.due(std::chrono::steady_clock::now());
    lock.unlock();
    if (!due.empty()) again_(due);
    std::this_thread::sleep_for(kNap);
    lock.lock();
  }
}

}  // namespace telekerf::bus
