// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "common/bus/middleware.h"
#include "common/bus/outbox.h"
#include "common/bus/qos.h"
#include "common/bus/topic.h"
#include "common/bus/wire.h"

namespace telekerf {
namespace dds = middleware::dds;

template <class T>
struct Writer<T>::Impl : dds::DataWriterListener, Bus::Participant::Endpoint {
  using Topic = bus::Topic<T>;
  using Wire = typename Topic::Type::type;
  static constexpr bool kLatched =
      Topic::kIntent == bus::Intent::kLatched || Topic::kIntent == bus::Intent::kStop;

  explicit Impl(Bus& bus) : participant(bus.participant()) {
    participant->add(this);
    // Protecting a message allocates: a stream's blocks leave the control loop for a thread that may.
    if constexpr (Topic::kIntent == bus::Intent::kStream) {
      if (participant->protection().on()) outbox.emplace([this](Wire& value) { (void)send_at_once(value); });
    }
  }
  ~Impl() override {
    outbox.reset();
    participant->remove(this);
  }

  /// What is latched is said again by a new writer.
  void open() override {
    const Turn turn(*this);
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
    for (Wire& value : kept) (void)lanes[0]->write(&value);
  }
  void close() override {
    const Turn turn(*this);
    remove_lanes();
  }
  void remove_lanes() {
    for (dds::DataWriter*& lane : lanes) {
      if (lane == nullptr) continue;
      lane->set_listener(nullptr);
      participant->publisher()->delete_datawriter(lane);
      lane = nullptr;
    }
    matched = 0;
  }

  /// Who writes, and who makes the lanes anew, one at a time.
  struct Release {
    std::atomic_flag& busy;
    ~Release() { busy.clear(std::memory_order_release); }
  };
  struct Turn : Release {
    explicit Turn(Impl& impl) : Release{impl.busy} {
      while (this->busy.test_and_set(std::memory_order_acquire))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  bool send(Wire& value) {
    next = (next + 1) % lanes.size();
    if (lanes[next] == nullptr || !middleware::succeeded(lanes[next]->write(&value))) return false;
    if constexpr (kLatched) {
      if (kept.size() == bus::kept_samples(Topic::kIntent)) kept.erase(kept.begin());
      kept.push_back(value);
    }
    return true;
  }
  /// A block does not wait for lanes that are made anew: it is lost, as on the way.
  bool send_at_once(Wire& value) {
    if (busy.test_and_set(std::memory_order_acquire)) return false;
    const Release end{busy};
    return send(value);
  }
  bool prepare(const T& value, Wire& into) { return to_wire(value, participant->settings().contract, into); }

  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    matched.fetch_add(status.current_count_change, std::memory_order_relaxed);
  }

  std::shared_ptr<Bus::Participant> participant;
  std::array<dds::DataWriter*, Topic::kLanes> lanes{};
  std::size_t next = 0;
  std::atomic_flag busy = ATOMIC_FLAG_INIT;  // written, or made anew
  bus::ToWire<T> to_wire;
  Wire wire;                                // reused, so that a stream allocates nothing
  std::vector<Wire> kept;                   // as many of the latched as whoever comes late gets
  std::atomic<int> matched{0};              // over all lanes
  std::optional<bus::Outbox<Wire>> outbox;  // of a stream, with security
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
    if constexpr (bus::Topic<T>::kIntent == bus::Intent::kStream) {
      if (!impl_->outbox) return impl_->prepare(value, impl_->wire) && impl_->send_at_once(impl_->wire);
      auto* const room = impl_->outbox->room();
      if (room == nullptr || !impl_->prepare(value, *room)) return false;
      impl_->outbox->post();
      return true;
    } else {
      const typename Impl::Turn turn(*impl_);
      return impl_->prepare(value, impl_->wire) && impl_->send(impl_->wire);
    }
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
    if (lane == nullptr) return false;
    const middleware::Duration_t at_most(std::max(left.count(), 1e-3));
    if (!middleware::succeeded(lane->wait_for_acknowledgments(at_most))) return false;
  }
  return true;
}

template class Writer<CommandBlock>;
template class Writer<StateBlock>;
template class Writer<ContourMessage>;
template class Writer<EventMessage>;
template class Writer<StopMessage>;
template class Writer<PreviewMessage>;
template class Writer<TelemetryMessage>;

}  // namespace telekerf
