// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/tun_link.h"

#include <fmt/format.h>
#include <sys/prctl.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <system_error>

#include "common/runtime/startup_error.h"
#include "netem/core/emulator.h"
#include "netem/core/trace.h"

namespace telekerf::netem {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

constexpr Capacity kLinkCapacity{1U << 17, 64U << 20, 1U << 16};
constexpr int kBatch = 64;  // packets read before the other direction has its turn

/// One direction: reads packets from where they enter, writes them where they leave when they are due.
class OneWay {
 public:
  OneWay(asio::io_context& io, asio::posix::stream_descriptor& from, asio::posix::stream_descriptor& to,
         const DirectionProfile& profile, const StreamKey& key)
      : from_(from), to_(to), timer_(io), emulator_(profile, key, kLinkCapacity, now_ns()) {}

  /// Writes the outcome of every packet from now on. Throws StartupError.
  void record(const std::filesystem::path& file) {
    trace_.reset(std::fopen(file.c_str(), "w"));
    if (!trace_) throw environment_error(fmt::format("cannot write {}", file.string()));
    fmt::print(trace_.get(), "{}\n", kTraceHeader);
  }

  void start() {
    from_.async_wait(asio::posix::stream_descriptor::wait_read,
                     [this](const boost::system::error_code& error) {
                       if (error) return;
                       take_in();
                       start();
                     });
  }
  void stop() { timer_.cancel(); }
  void switch_to(const DirectionProfile& profile) {
    CompiledProfile fresh(profile);
    emulator_.switch_to(fresh, now_ns());
    let_out();  // what waited may be due sooner
  }
  const Counters& counters() const { return emulator_.counters(); }
  std::uint64_t refused() const { return refused_; }
  std::int64_t latest_ns() const { return latest_ns_; }

 private:
  void take_in() {
    for (int i = 0; i < kBatch; ++i) {
      const ssize_t size = ::read(from_.native_handle(), buffer_.data(), buffer_.size());
      if (size <= 0) break;  // empty, or the device is going away
      const std::int64_t now = now_ns();
      const PacketOutcome outcome =
          emulator_.push(now, std::span(buffer_).first(static_cast<std::size_t>(size)), 0);
      if (trace_) write_down(now, outcome);
    }
    let_out();
  }

  void write_down(std::int64_t now, const PacketOutcome& outcome) {
    if (recorded_ == 0) recording_began_ns_ = now;
    const RecordedOutcome row{now - recording_began_ns_, outcome.lost() ? 0 : outcome.due_ns - now,
                              outcome.lost(), outcome.duplicated, outcome.corrupted};
    fmt::print(trace_.get(), "{}\n", trace_row(recorded_++, row));
  }

  void let_out() {
    for (;;) {
      const std::int64_t now = now_ns();
      const auto delivery = emulator_.pop(now);
      if (!delivery) break;
      latest_ns_ = std::max(latest_ns_, now - delivery->due_ns);
      const ssize_t written = ::write(to_.native_handle(), delivery->bytes.data(), delivery->bytes.size());
      // A corrupted header is no IP packet any more: the kernel refuses it, as a network card would have.
      if (written < 0 && !delivery->corrupted) ++refused_;
    }
    const auto deadline = emulator_.next_deadline();
    if (!deadline || *deadline == armed_for_ns_) return;
    armed_for_ns_ = *deadline;
    timer_.expires_at(Clock::time_point(std::chrono::nanoseconds(*deadline)));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      armed_for_ns_ = 0;
      let_out();
    });
  }

  asio::posix::stream_descriptor& from_;
  asio::posix::stream_descriptor& to_;
  asio::steady_timer timer_;
  Emulator emulator_;
  std::array<std::byte, 1U << 16> buffer_;
  std::int64_t armed_for_ns_ = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> trace_{nullptr, &std::fclose};
  std::uint64_t recorded_ = 0;
  std::int64_t recording_began_ns_ = 0;
  std::uint64_t refused_ = 0;
  std::int64_t latest_ns_ = 0;
};

void report(const char* name, const OneWay& way) {
  const Counters& c = way.counters();
  fmt::print(
      "{:<9} in {:>9}  out {:>9}  lost {:>7}  queue full {:>6}  after the recording {:>6}  duplicated {:>6}  "
      "corrupted {:>6}  "
      "overflowed {}  "
      "refused {}  latest {:.3f} ms after its due time\n",
      name, c.pushed, c.delivered, c.lost, c.queue_full, c.after_trace, c.duplicated, c.corrupted,
      c.overflowed, way.refused(), static_cast<double>(way.latest_ns()) * 1e-6);
}

}  // namespace

int run_link(const LinkOptions& options) {
  const Profile profile = load_profile(options.profile);
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // wake at the due time, not up to 50 us later
  asio::io_context io(1);
  asio::posix::stream_descriptor operator_side(io, open_tun(options.operator_side));
  asio::posix::stream_descriptor slave_side(io, open_tun(options.slave_side));
  // Large buffers inside: not on the stack.
  const auto forward = std::make_unique<OneWay>(io, operator_side, slave_side, profile.forward,
                                                StreamKey{options.seed, 0, Direction::kForward});
  const auto backward = std::make_unique<OneWay>(io, slave_side, operator_side, profile.backward,
                                                 StreamKey{options.seed, 0, Direction::kBackward});
  if (!options.record.empty()) {
    std::error_code ignored;  // opening the files tells
    std::filesystem::create_directories(options.record, ignored);
    forward->record(std::filesystem::path(options.record) / "forward.csv");
    backward->record(std::filesystem::path(options.record) / "backward.csv");
  }
  forward->start();
  backward->start();

  asio::signal_set stop(io, SIGINT, SIGTERM);
  stop.async_wait([&](const boost::system::error_code& error, int) {
    if (!error) io.stop();
  });
  asio::signal_set again(io, SIGHUP);
  std::function<void(const boost::system::error_code&, int)> reload =
      [&](const boost::system::error_code& error, int) {
        if (error) return;
        try {
          const Profile fresh = load_profile(options.profile);
          forward->switch_to(fresh.forward);
          backward->switch_to(fresh.backward);
          fmt::print("switched to {} as it is now\n", fresh.name);
        } catch (const StartupError& refusal) {  // a running link stays up
          fmt::print(stderr, "telekerf-netem: {}; the old profile stays\n", refusal.what());
        }
        std::fflush(stdout);
        again.async_wait(reload);
      };
  again.async_wait(reload);
  asio::steady_timer end(io);
  if (options.seconds > 0) {
    end.expires_after(
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds)));
    end.async_wait([&](const boost::system::error_code& error) {
      if (!error) io.stop();
    });
  }
  fmt::print("link up: {} ({}) <-> {} ({}), profile {}, seed {}\n", options.operator_side.device,
             options.operator_side.address, options.slave_side.device, options.slave_side.address,
             profile.name, options.seed);
  if (const std::string note = trace_note(profile); !note.empty()) fmt::print("{}\n", note);
  std::fflush(stdout);
  io.run();

  report("forward", *forward);
  report("backward", *backward);
  const auto unintended = [](const OneWay& way) { return way.counters().overflowed + way.refused(); };
  return unintended(*forward) + unintended(*backward) == 0 ? 0 : 1;
}

}  // namespace telekerf::netem
