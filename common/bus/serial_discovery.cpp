// SPDX-License-Identifier: Apache-2.0
#include "common/bus/serial_discovery.h"

#include <mutex>
#include <span>
#include <utility>

#include "common/bus/rtps_message.h"

namespace telekerf::bus {
namespace {

namespace dds_rtps = eprosima::fastdds::rtps;
using middleware::rtps::Locator_t;
using middleware::rtps::LocatorsIterator;
using middleware::rtps::octet;
using middleware::rtps::SenderResource;

class SerialTransport : public dds_rtps::ChainingTransport {
 public:
  explicit SerialTransport(const dds_rtps::ChainingTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor.low_level_descriptor) {}

  dds_rtps::TransportDescriptorInterface* get_configuration() override { return descriptor_.get(); }

  bool send(SenderResource* below, middleware::Datagram whole, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(whole, size, begin, end, timeout);
  }

  void receive(dds_rtps::TransportReceiverInterface* next, const octet* buffer, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    std::unique_lock<std::mutex> turn(turns_, std::defer_lock);
    if (!is_protected(std::as_bytes(std::span(buffer, size)))) turn.lock();
    next->OnDataReceived(buffer, size, local, remote);
  }

 private:
  std::shared_ptr<dds_rtps::TransportDescriptorInterface> descriptor_;
  std::mutex turns_;
};

struct SerialDescriptor : dds_rtps::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  dds_rtps::TransportInterface* create_transport() const override { return new SerialTransport(*this); }
};

}  // namespace

std::shared_ptr<dds_rtps::TransportDescriptorInterface> one_by_one_over(
    std::shared_ptr<dds_rtps::TransportDescriptorInterface> below) {
  return std::make_shared<SerialDescriptor>(std::move(below));
}

}  // namespace telekerf::bus
