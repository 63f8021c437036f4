// SPDX-License-Identifier: Apache-2.0
#include "common/bus/endpoints.h"

#include <array>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <thread>

#include "common/bus/participant.h"
#include "common/bus/qos.h"
#include "common/bus/ring.h"
#include "common/bus/topics.h"
#include "common/bus/wire.h"
#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

/// Set by a type's deserializer, read by the listener that called it, in one thread: bytes that are not even
/// CDR.
thread_local bool undecodable = false;  // NOLINT

/// Generated serializers throw through the middleware when bytes are broken in some places and return false
/// in others.
template <class Type>
class Guarded : public Type {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    bool good = false;
    try {
      good = Type::deserialize(payload, data);
    } catch (const std::exception&) {
    }
    undecodable = undecodable || !good;
    return good;
  }
};

template <class T>
dds::Topic* topic_of(Bus::Participant& participant) {
  using Topic = bus::Topic<T>;
  dds::Topic* topic = participant.topic(Topic::kName, dds::TypeSupport(new Guarded<typename Topic::Type>));
  if (topic == nullptr) throw StartupError(std::string("the middleware refused topic ") + Topic::kName);
  return topic;
}

}  // namespace

template <class T>
struct Writer<T>::Impl : dds::DataWriterListener {
  using Topic = bus::Topic<T>;

  explicit Impl(Bus& bus) : participant(bus.participant()) {
    for (int lane = 0; lane < Topic::kLanes; ++lane) {
      dds::DataWriterQos qos = bus::writer_qos(Topic::kIntent);
      if (Topic::kEntity != 0) qos.endpoint().entity_id = static_cast<std::int16_t>(Topic::kEntity + lane);
      lanes[lane] = participant->publisher()->create_datawriter(topic_of<T>(*participant), qos, this,
                                                                dds::StatusMask::publication_matched());
      if (lanes[lane] == nullptr) {
        remove_lanes();
        throw StartupError(std::string("the middleware refused a writer of ") + Topic::kName);
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
    if (!bus::to_wire(value, impl_->participant->settings().contract, impl_->wire)) return false;
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

template <class T>
struct Reader<T>::Impl : dds::DataReaderListener {
  Impl(Bus& bus, std::size_t capacity)
      : participant(bus.participant()), ring(capacity == 0 ? bus::Topic<T>::kRing : capacity) {
    reader = participant->subscriber()->create_datareader(
        topic_of<T>(*participant), bus::reader_qos(bus::Topic<T>::kIntent), this,
        dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
    if (reader == nullptr)
      throw StartupError(std::string("the middleware refused a reader of ") + bus::Topic<T>::kName);
  }
  ~Impl() override {
    reader->set_listener(nullptr);
    participant->subscriber()->delete_datareader(reader);
  }

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    matched.fetch_add(status.current_count_change, std::memory_order_relaxed);
  }

  /// In a thread of the middleware: take, judge, stamp, hand over. Several of its threads may come, each with
  /// locks of the middleware that taking needs as well, so nobody waits here: whoever comes second leaves the
  /// work to the first, who goes round once more. So the ring has one producer at a time.
  void on_data_available(dds::DataReader* source) override {
    if (calls.fetch_add(1, std::memory_order_acq_rel) != 0) return;
    unsigned answered = 0;
    do {
      answered = calls.load(std::memory_order_acquire);
      drain(source);
    } while (calls.fetch_sub(answered, std::memory_order_acq_rel) != answered);
  }

  void drain(dds::DataReader* source) {
    const std::int64_t now_ns = monotonic_ns();
    dds::SampleInfo info;
    while (true) {
      undecodable = false;
      const bool taken = source->take_next_sample(&wire, &info) == ReturnCode_t::RETCODE_OK;
      if (undecodable) {
        damaged.fetch_add(1, std::memory_order_relaxed);
        if (!taken) continue;
      } else if (!taken) {
        return;
      } else if (info.valid_data && !participant->is_own(info.sample_identity.writer_guid())) {
        accept(now_ns);
      }
    }
  }

  void accept(std::int64_t now_ns) {
    Received<T> sample;
    sample.received_ns = now_ns;
    switch (bus::from_wire(wire, participant->settings().contract, sample.value)) {
      case bus::Verdict::kGood:
        received.fetch_add(1, std::memory_order_relaxed);
        ring.push(std::move(sample));
        return;
      case bus::Verdict::kDamaged:
        damaged.fetch_add(1, std::memory_order_relaxed);
        return;
      case bus::Verdict::kForeignContract:
        foreign.fetch_add(1, std::memory_order_relaxed);
        return;
    }
  }

  std::shared_ptr<Bus::Participant> participant;
  dds::DataReader* reader = nullptr;
  std::atomic<unsigned> calls{0};
  typename bus::Topic<T>::Type::type wire;
  Ring<Received<T>> ring;
  std::atomic<int> matched{0};
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> damaged{0};
  std::atomic<std::uint64_t> foreign{0};
};

template <class T>
Reader<T>::Reader(Bus& bus, std::size_t capacity) : impl_(std::make_unique<Impl>(bus, capacity)) {}
template <class T>
Reader<T>::~Reader() = default;
template <class T>
Reader<T>::Reader(Reader&&) noexcept = default;
template <class T>
Reader<T>& Reader<T>::operator=(Reader&&) noexcept = default;

template <class T>
std::optional<Received<T>> Reader<T>::take() noexcept {
  return impl_->ring.take();
}

template <class T>
ReaderCounters Reader<T>::counters() const noexcept {
  return {.received = impl_->received.load(std::memory_order_relaxed),
          .damaged = impl_->damaged.load(std::memory_order_relaxed),
          .foreign_contract = impl_->foreign.load(std::memory_order_relaxed),
          .dropped = impl_->ring.dropped()};
}

template <class T>
int Reader<T>::writers() const noexcept {
  return impl_->matched.load(std::memory_order_relaxed) / bus::Topic<T>::kLanes;
}

template class Writer<CommandBlock>;
template class Writer<StateBlock>;
template class Writer<ContourMessage>;
template class Writer<EventMessage>;
template class Writer<TelemetryMessage>;
template class Reader<CommandBlock>;
template class Reader<StateBlock>;
template class Reader<ContourMessage>;
template class Reader<EventMessage>;
template class Reader<TelemetryMessage>;

}  // namespace telekerf
