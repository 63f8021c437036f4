// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/receive_path_emulator.h"

#include <sys/prctl.h>

#include <algorithm>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "common/bus/middleware.h"
#include "common/runtime/clock.h"
#include "netem/core/emulator.h"
#include "netem/drivers/datagram.h"

namespace telekerf::netem {
namespace {

namespace rtps = eprosima::fastdds::rtps;
using middleware::rtps::Locator_t;
using middleware::rtps::LocatorsIterator;
using middleware::rtps::octet;
using middleware::rtps::SenderResource;

// Room for a large contour on a long link: 16 MB.
constexpr Capacity kCapacity{.packets = 16384, .bytes = 16U << 20, .largest_packet = 65536};

Site other_site(Site own) { return own == Site::kSlave ? Site::kOperator : Site::kSlave; }

const DirectionProfile& into(Site own, const Profile& profile) {
  return own == Site::kSlave ? profile.forward : profile.backward;
}

/// One open port. The middleware's receiver is not made for two threads, so whoever delivers holds
/// `delivering`.
struct Channel {
  Locator_t local;
  std::mutex delivering;
  rtps::TransportReceiverInterface* next = nullptr;  // null: closed; guarded by the link's mutex
};

/// Where a packet in the emulator belongs, with what it takes to see where it was damaged; all in its 64-bit
/// tag.
struct Tag {
  std::uint16_t route = 0;
  Range payload;
  std::uint8_t parity = 0;

  std::uint64_t packed() const {
    return std::uint64_t{route} | std::uint64_t{payload.begin} << 16 | std::uint64_t{payload.end} << 32 |
           std::uint64_t{parity} << 48;
  }
  static Tag unpacked(std::uint64_t tag) {
    return {static_cast<std::uint16_t>(tag),
            {static_cast<std::uint16_t>(tag >> 16), static_cast<std::uint16_t>(tag >> 32)},
            static_cast<std::uint8_t>(tag >> 48)};
  }
};

}  // namespace

class ReceivePathEmulator::State {
 public:
  State(const Profile& profile, std::uint64_t seed, Site own)
      : own_(own),
        other_(other_site(own)),
        emulator_(into(own, profile),
                  {.seed = seed,
                   .flow = 0,
                   .direction = own == Site::kSlave ? Direction::kForward : Direction::kBackward},
                  kCapacity, monotonic_ns()) {}

  void set_profile(const Profile& profile) {
    // Takes the old one home: both are built and freed outside the lock.
    CompiledProfile fresh(into(own_, profile));
    {
      const std::lock_guard lock(mutex_);
      emulator_.switch_to(fresh, monotonic_ns());
    }
    wake_.notify_one();  // what waited may be due sooner
  }

  TransportCounters counters() const {
    const std::lock_guard lock(mutex_);
    const Counters& emulator = emulator_.counters();
    return {.emulated = emulator.pushed,
            .delivered = delivered_,
            .lost = emulator.lost + emulator.queue_full + emulator.after_trace,
            .overflowed = emulator.overflowed,
            .corrupted = emulator.corrupted,
            .delivered_corrupted = delivered_corrupted_,
            .earliest_ns = delivered_ == 0 ? 0 : earliest_ns_,
            .latest_ns = latest_ns_};
  }

  void know(const SiteTable& sites) { sites_ = sites; }
  void start() {
    thread_ = std::thread([this] { deliver_until_stopped(); });
  }
  void stop() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

  /// In the middleware's receiving thread.
  void receive(rtps::TransportReceiverInterface* next, std::span<const std::byte> datagram,
               const Locator_t& local, const Locator_t& remote) {
    if (site_of(datagram, sites_) != other_) {
      Channel* channel = nullptr;
      {
        const std::lock_guard lock(mutex_);
        channel = &channel_of(local, next);
      }
      const std::lock_guard delivering(channel->delivering);
      next->OnDataReceived(reinterpret_cast<const octet*>(datagram.data()),
                           static_cast<std::uint32_t>(datagram.size()), local, remote);
      return;
    }
    const Range payload = stream_payload(datagram);
    const std::uint8_t parity =
        payload.begin == payload.end ? std::uint8_t{0} : parity_outside(datagram, payload);
    bool earlier = false;
    {
      const std::lock_guard lock(mutex_);
      const auto route = route_of(local, remote, next);
      if (!route) return;
      const auto before = emulator_.next_deadline();
      emulator_.push(monotonic_ns(), datagram, Tag{*route, payload, parity}.packed());
      const auto after = emulator_.next_deadline();
      earlier = after && (!before || *after < *before);
    }
    if (earlier) wake_.notify_one();
  }

  /// No more deliveries to this port, and none in flight when it returns.
  void close(const Locator_t& local) {
    std::vector<Channel*> closed;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& channel : channels_) {
        if (!(channel->local == local) || channel->next == nullptr) continue;
        channel->next = nullptr;
        closed.push_back(channel.get());
      }
    }
    for (Channel* channel : closed) const std::lock_guard wait(channel->delivering);
  }

 private:
  struct Route {
    Channel* channel;
    Locator_t remote;
  };

  Channel& channel_of(const Locator_t& local, rtps::TransportReceiverInterface* next) {
    for (const auto& channel : channels_) {
      if (channel->next == next && channel->local == local) return *channel;
    }
    channels_.push_back(std::make_unique<Channel>());
    channels_.back()->local = local;
    channels_.back()->next = next;
    return *channels_.back();
  }

  std::optional<std::uint16_t> route_of(const Locator_t& local, const Locator_t& remote,
                                        rtps::TransportReceiverInterface* next) {
    Channel* channel = &channel_of(local, next);
    for (std::size_t i = 0; i < routes_.size(); ++i) {
      if (routes_[i].channel == channel && routes_[i].remote == remote) return static_cast<std::uint16_t>(i);
    }
    if (routes_.size() > std::numeric_limits<std::uint16_t>::max()) return std::nullopt;
    routes_.push_back({channel, remote});
    return static_cast<std::uint16_t>(routes_.size() - 1);
  }

  void deliver_until_stopped() {
    prctl(PR_SET_TIMERSLACK, 1UL);  // wake at the deadline, not 50 us after it
    std::vector<std::byte> datagram;
    datagram.reserve(kCapacity.largest_packet);
    std::unique_lock lock(mutex_);
    while (!stopped_) {
      const auto deadline_ns = emulator_.next_deadline();
      if (!deadline_ns) {
        wake_.wait(lock);
        continue;
      }
      const std::int64_t now_ns = monotonic_ns();
      const auto delivery = emulator_.pop(now_ns);
      if (!delivery) {
        wake_.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*deadline_ns)));
        continue;
      }
      const Tag tag = Tag::unpacked(delivery->tag);
      if (delivery->corrupted && !damage_is_for_the_bus(*delivery, tag)) continue;
      delivered_corrupted_ += delivery->corrupted ? 1 : 0;
      ++delivered_;
      earliest_ns_ = std::min(earliest_ns_, now_ns - delivery->due_ns);
      latest_ns_ = std::max(latest_ns_, now_ns - delivery->due_ns);
      datagram.assign(delivery->bytes.begin(), delivery->bytes.end());
      const Route route = routes_[tag.route];
      lock.unlock();
      hand_over(route, datagram);
      lock.lock();
    }
  }

  static bool damage_is_for_the_bus(const Delivery& delivery, const Tag& tag) {
    return tag.payload.begin != tag.payload.end && parity_outside(delivery.bytes, tag.payload) == tag.parity;
  }

  void hand_over(const Route& route, const std::vector<std::byte>& datagram) {
    const std::lock_guard delivering(route.channel->delivering);
    rtps::TransportReceiverInterface* next = nullptr;
    {
      const std::lock_guard lock(mutex_);
      next = route.channel->next;  // close() waits for `delivering` after it has taken this away
    }
    if (next == nullptr) return;
    next->OnDataReceived(reinterpret_cast<const octet*>(datagram.data()),
                         static_cast<std::uint32_t>(datagram.size()), route.channel->local, route.remote);
  }

  const Site own_;
  const Site other_;
  SiteTable sites_;  // set before the first datagram
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Emulator emulator_;
  std::vector<std::unique_ptr<Channel>> channels_;
  std::vector<Route> routes_;
  bool stopped_ = false;
  std::uint64_t delivered_ = 0;
  std::uint64_t delivered_corrupted_ = 0;
  std::int64_t earliest_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t latest_ns_ = 0;
  std::thread thread_;
};

namespace {

struct Descriptor;

class Transport : public rtps::ChainingTransport {
 public:
  Transport(const rtps::ChainingTransportDescriptor& descriptor,
            std::shared_ptr<ReceivePathEmulator::State> link)
      : ChainingTransport(descriptor), descriptor_(descriptor.low_level_descriptor), link_(std::move(link)) {
    link_->start();
  }
  ~Transport() override { link_->stop(); }

  rtps::TransportDescriptorInterface* get_configuration() override { return descriptor_.get(); }

  bool send(SenderResource* below, middleware::Datagram datagram, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(datagram, size, begin, end, timeout);
  }

  void receive(rtps::TransportReceiverInterface* next, const octet* buffer, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    link_->receive(next, std::as_bytes(std::span(buffer, size)), local, remote);
  }

  bool CloseInputChannel(const Locator_t& local) override {
    const bool closed = ChainingTransport::CloseInputChannel(local);
    link_->close(local);
    return closed;
  }

 private:
  std::shared_ptr<rtps::TransportDescriptorInterface> descriptor_;
  std::shared_ptr<ReceivePathEmulator::State> link_;
};

struct Descriptor : rtps::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<rtps::TransportDescriptorInterface> below,
             std::shared_ptr<ReceivePathEmulator::State> state)
      : ChainingTransportDescriptor(std::move(below)), link(std::move(state)) {}
  rtps::TransportInterface* create_transport() const override { return new Transport(*this, link); }

  std::shared_ptr<ReceivePathEmulator::State> link;
};

}  // namespace

ReceivePathEmulator::ReceivePathEmulator(const Profile& profile, std::uint64_t seed, Site own_site)
    : state_(std::make_shared<State>(profile, seed, own_site)) {}
ReceivePathEmulator::~ReceivePathEmulator() = default;
void ReceivePathEmulator::set_profile(const Profile& profile) { state_->set_profile(profile); }
TransportCounters ReceivePathEmulator::counters() const { return state_->counters(); }

std::shared_ptr<ReceiveFilter::Transport> ReceivePathEmulator::over(std::shared_ptr<Transport> below,
                                                                    const SiteTable& sites) {
  state_->know(sites);
  return std::make_shared<Descriptor>(std::move(below), state_);
}

}  // namespace telekerf::netem
