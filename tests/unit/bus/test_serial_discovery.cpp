// SPDX-License-Identifier: Apache-2.0
// Two threads that receive: what is not protected reaches the middleware one at a time, the rest when it
// comes.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "common/bus/serial_discovery.h"

namespace telekerf::bus {
namespace {

namespace dds_rtps = eprosima::fastdds::rtps;
using namespace std::chrono_literals;
using Bytes = std::vector<middleware::rtps::octet>;

/// A datagram whose first submessage is of that kind.
Bytes datagram(std::uint8_t kind) {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  bytes.insert(bytes.end(), 12, 0x6d);
  bytes.insert(bytes.end(), {kind, 0x01, 4, 0, 1, 2, 3, 4});
  return bytes;
}
constexpr std::uint8_t kData = 0x15, kProtected = 0x33;

/// Stays in the first call until another one has come in as well, or it has waited long enough for it.
class Receiver : public dds_rtps::TransportReceiverInterface {
 public:
  explicit Receiver(std::chrono::milliseconds patience) : patience_(patience) {}
  void OnDataReceived(const middleware::rtps::octet*, const std::uint32_t, const middleware::rtps::Locator_t&,
                      const middleware::rtps::Locator_t&) override {
    ++calls;
    if (++inside_ == 2) together = true;
    const auto end = std::chrono::steady_clock::now() + patience_;
    while (!together && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
    --inside_;
  }
  std::atomic<int> calls{0};
  std::atomic<bool> together{false};

 private:
  std::chrono::milliseconds patience_;
  std::atomic<int> inside_{0};
};

/// Whether two of these, on two ports, were ever in the receiver at the same time.
bool meet(std::uint8_t first, std::uint8_t second, std::chrono::milliseconds patience) {
  const auto descriptor = one_by_one_over(std::make_shared<dds_rtps::UDPv4TransportDescriptor>());
  const std::unique_ptr<dds_rtps::TransportInterface> made(descriptor->create_transport());
  auto* const transport = dynamic_cast<dds_rtps::ChainingTransport*>(made.get());
  Receiver receiver(patience);
  const auto receive = [&](std::uint8_t kind) {
    const Bytes bytes = datagram(kind);
    const middleware::rtps::Locator_t here, there;
    transport->receive(&receiver, bytes.data(), static_cast<std::uint32_t>(bytes.size()), here, there);
  };
  std::thread multicast(receive, first);
  std::thread unicast(receive, second);
  multicast.join();
  unicast.join();
  EXPECT_EQ(receiver.calls, 2) << "nothing is lost";
  return receiver.together;
}

TEST(SerialDiscovery, TwoAnnouncementsAreTakenOneAfterTheOther) { EXPECT_FALSE(meet(kData, kData, 200ms)); }

TEST(SerialDiscovery, WhatIsProtectedWaitsForNobody) {
  EXPECT_TRUE(meet(kData, kProtected, 20s));
  EXPECT_TRUE(meet(kProtected, kProtected, 20s));
}

}  // namespace
}  // namespace telekerf::bus
