// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <thread>

#include "common/bus/qos.h"
#include "common/bus/topic.h"
#include "common/bus/wire.h"

namespace telekerf {
namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

template <class T>
struct Writer<T>::Impl : dds::DataWriterListener {
  using Topic = bus::Topic<T>;

  explicit Impl(Bus& bus) : participant(bus.participant()) {
    for (int lane = 0; lane < Topic::kLanes; ++lane) {
      dds::DataWriterQos qos = bus::writer_qos(Topic::kIntent);
      if (Topic::kEntity != 0) qos.endpoint().entity_id = static_cast<std::int16_t>(Topic::kEntity + lane);
      lanes[lane] = participant->publisher()->create_datawriter(bus::topic_of<T>(*participant), qos, this,
                                                                dds::StatusMask::publication_matched());
      if (lanes[lane] == nullptr) {
        remove_lanes();
        throw environment_error(std::string("the middleware refused a writer of ") + Topic::kName);
      }
    }
  }
  ~Impl() override { remove_lanes(); }

  void remove_lanes() {
    for (dds::DataWriter* lane : lanes) {
      if (lane == nullptr) continue;
      lane->set_listener(nullptr);
      participant->publisher()->delete_datawriter(lane);
    }
  }

  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    matched.fetch_add(status.current_count_change, std::memory_order_relaxed);
  }

  std::shared_ptr<Bus::Participant> participant;
  std::array<dds::DataWriter*, Topic::kLanes> lanes{};
  std::size_t turn = 0;
  bus::ToWire<T> to_wire;
  typename Topic::Type::type wire;  // reused, so that a stream allocates nothing
  std::atomic<int> matched{0};      // over all lanes
};

template <class T>
Writer<T>::Writer(Bus& bus) : impl_(std::make_unique<Impl>(bus)) {}
template <class T>
Writer<T>::~Writer() = default;
template <class T>
Writer<T>::Writer(Writer&&) noexcept = default;
template <class T>
Writer<T>& Writer<T>::operator=(Writer&&) noexcept = default;

template <class T>
bool Writer<T>::write(const T& value) noexcept {
  try {
    if (!impl_->to_wire(value, impl_->participant->settings().contract, impl_->wire)) return false;
    impl_->turn = (impl_->turn + 1) % impl_->lanes.size();
    return impl_->lanes[impl_->turn]->write(&impl_->wire);
  } catch (const std::exception&) {
    return false;
  }
}

template <class T>
int Writer<T>::readers() const noexcept {
  return impl_->matched.load(std::memory_order_relaxed) / bus::Topic<T>::kLanes;
}

template <class T>
bool Writer<T>::wait_for_reader(std::chrono::nanoseconds timeout, int count) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (readers() < count) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

template <class T>
bool Writer<T>::wait_until_received(std::chrono::nanoseconds timeout) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (dds::DataWriter* lane : impl_->lanes) {
    const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
    if (lane->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(std::max(left.count(), 1e-3))) !=
        ReturnCode_t::RETCODE_OK) {
      return false;
    }
  }
  return true;
}

template class Writer<CommandBlock>;
template class Writer<StateBlock>;
template class Writer<ContourMessage>;
template class Writer<EventMessage>;
template class Writer<StopMessage>;
template class Writer<TelemetryMessage>;

}  // namespace telekerf
