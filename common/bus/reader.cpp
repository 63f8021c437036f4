// SPDX-License-Identifier: Apache-2.0
#include "common/bus/reader.h"

#include <atomic>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "common/bus/middleware.h"
#include "common/bus/qos.h"
#include "common/bus/ring.h"
#include "common/bus/topic.h"
#include "common/bus/wire.h"
#include "common/runtime/clock.h"

namespace telekerf {
namespace dds = middleware::dds;

template <class T>
struct Reader<T>::Impl : dds::DataReaderListener, Bus::Participant::Endpoint {
  Impl(Bus& bus, std::size_t capacity, std::function<void(const T&)> to = {})
      : participant(bus.participant()),
        ring(capacity == 0 ? bus::Topic<T>::kRing : capacity),
        tap(std::move(to)) {
    participant->add(this);
  }
  ~Impl() override { participant->remove(this); }

  void open() override {
    reader = participant->subscriber()->create_datareader(
        bus::topic_of<T>(*participant), bus::reader_qos(bus::Topic<T>::kIntent), this,
        dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
    if (reader == nullptr)
      throw environment_error(std::string("the middleware refused a reader of ") + bus::Topic<T>::kName);
  }
  void close() override {
    if (reader == nullptr) return;
    reader->set_listener(nullptr);
    participant->subscriber()->delete_datareader(reader);
    reader = nullptr;
    matched = 0;
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
      bus::undecodable = false;
      const bool taken = middleware::succeeded(source->take_next_sample(&wire, &info));
      if (bus::undecodable) {
        damaged.fetch_add(1, std::memory_order_relaxed);
        if (!taken) continue;
      } else if (!taken) {
        return;
      } else if (info.valid_data && !participant->is_own(info.sample_identity.writer_guid())) {
        accept(now_ns, info.sample_identity.writer_guid());
      }
    }
  }

  /// Whether what is in `wire` may come from this writer. Who announces itself as another start than the
  /// stream's own is not the one who sends it. A stop is heard from everyone: it can only make things safer,
  /// and who says it may not be known yet. What speaks another contract is judged by that.
  bool may_say(const middleware::rtps::GUID_t& writer, std::optional<std::uint32_t> epoch) {
    if (bus::contract_of(wire).value_or(participant->settings().contract) != participant->settings().contract)
      return true;
    if constexpr (std::is_same_v<T, StopMessage>) {
      if (wire.in_force() != 0) return true;
    }
    return participant->may_say(writer, bus::Topic<T>::kName, bus::Topic<T>::kFrom, epoch);
  }

  void accept(std::int64_t now_ns, const middleware::rtps::GUID_t& writer) {
    if (!may_say(writer, std::nullopt)) {
      strangers.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    SenderKey sender;
    std::copy_n(writer.guidPrefix.value, sender.size(), sender.begin());
    Received<T> sample;
    sample.received_ns = now_ns;
    switch (from_wire(wire, sender, participant->settings().contract, sample.value)) {
      case Verdict::kGood:
        if constexpr (bus::Topic<T>::kIntent == bus::Intent::kStream) {
          if (!may_say(writer, sample.value.epoch)) {
            strangers.fetch_add(1, std::memory_order_relaxed);
            return;
          }
        }
        received.fetch_add(1, std::memory_order_relaxed);
        if (tap) {
          tap(sample.value);
        } else {
          ring.push(std::move(sample));
        }
        return;
      case Verdict::kDamaged:
        damaged.fetch_add(1, std::memory_order_relaxed);
        return;
      case Verdict::kForeignContract:
        foreign.fetch_add(1, std::memory_order_relaxed);
        return;
      case Verdict::kUnknownSet:
        unknown.fetch_add(1, std::memory_order_relaxed);
        return;
    }
  }

  std::shared_ptr<Bus::Participant> participant;
  dds::DataReader* reader = nullptr;
  std::atomic<unsigned> calls{0};
  bus::FromWire<T> from_wire;
  typename bus::Topic<T>::Type::type wire;
  Ring<Received<T>> ring;
  std::function<void(const T&)> tap;
  std::atomic<int> matched{0};
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> damaged{0};
  std::atomic<std::uint64_t> foreign{0};
  std::atomic<std::uint64_t> unknown{0};
  std::atomic<std::uint64_t> strangers{0};
};

template <class T>
Reader<T>::Reader(Bus& bus, std::size_t capacity) : impl_(std::make_unique<Impl>(bus, capacity)) {}
template <class T>
Reader<T>::Reader(Bus& bus, std::function<void(const T&)> tap)
    : impl_(std::make_unique<Impl>(bus, 1, std::move(tap))) {}
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
          .unknown_set = impl_->unknown.load(std::memory_order_relaxed),
          .strangers = impl_->strangers.load(std::memory_order_relaxed),
          .dropped = impl_->ring.dropped()};
}

template <class T>
int Reader<T>::writers() const noexcept {
  return impl_->matched.load(std::memory_order_relaxed) / bus::Topic<T>::kLanes;
}

template class Reader<CommandBlock>;
template class Reader<StateBlock>;
template class Reader<ContourMessage>;
template class Reader<EventMessage>;
template class Reader<StopMessage>;
template class Reader<PreviewMessage>;
template class Reader<TelemetryMessage>;

}  // namespace telekerf
