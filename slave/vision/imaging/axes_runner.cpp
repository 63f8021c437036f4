// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/axes_runner.h"

#include <utility>

#include "common/runtime/clock.h"

namespace telekerf::imaging {
namespace {

/// Axes that are not simulated here answer a period later.
AxesControlSettings settings_for(const AxesDevice& device) {
  return {.period_s = AxesRunner::kPeriod_s, .loop_delay = device.plant == nullptr ? 1.0 : 0.0};
}

}  // namespace

AxesRunner::AxesRunner(AxesDevice device, const AxesModel& model)
    : model_(model), device_(std::move(device)), control_(model, settings_for(device_)) {}

AxesRunner::~AxesRunner() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  device_.axes->write({});
}

void AxesRunner::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    constexpr auto kPeriod_ns = static_cast<std::int64_t>(kPeriod_s * 1e9);
    std::int64_t due_ns = monotonic_ns();
    // Simulated axes move by the steps, not by the clock: they cannot be late.
    const std::int64_t late_ns = AxesControl::kMaxBridged * kPeriod_ns;
    while (!stop.stop_requested()) {
      step(device_.plant == nullptr && monotonic_ns() - due_ns > late_ns);
      due_ns = next_deadline_ns(due_ns, kPeriod_ns, monotonic_ns());
      sleep_until_ns(due_ns);
    }
  });
}

void AxesRunner::order(std::size_t axis, Kind kind, double value) noexcept {
  Order& order = orders_[axis];
  order.value.store(value, std::memory_order_relaxed);
  order.kind.store(kind, std::memory_order_relaxed);
  order.count.fetch_add(1, std::memory_order_release);
}

bool AxesRunner::settled(std::size_t axis) const noexcept {
  const Order& order = orders_[axis];
  return state() == AxesControl::State::kReady &&
         order.settled.load(std::memory_order_acquire) == order.count.load(std::memory_order_relaxed);
}

void AxesRunner::take_orders() noexcept {
  for (const std::size_t axis : kBothAxes) {
    Order& order = orders_[axis];
    const std::uint64_t count = order.count.load(std::memory_order_acquire);
    if (count == order.taken) continue;
    order.taken = count;
    const double value = order.value.load(std::memory_order_relaxed);
    switch (order.kind.load(std::memory_order_relaxed)) {
      case Kind::kMove:
        control_.move_to(axis, value);
        break;
      case Kind::kApproach:
        control_.approach(axis, value);
        break;
      case Kind::kDrive:
        control_.drive(axis, value);
        break;
    }
  }
}

void AxesRunner::step(bool late) noexcept {
  AxesReading reading = device_.axes->read();
  if (late) {
    reading = {};
    control_.lapse();
  }
  if (control_.state() == AxesControl::State::kReady) take_orders();
  device_.axes->write(control_.step(reading));
  if (device_.plant != nullptr) device_.plant->advance(kPeriod_s);
  const AxisPositions measured = control_.positions_m();
  const AxisPositions optics = device_.plant != nullptr ? device_.plant->optics_m() : measured;
  measured_m_[kMagnification] = measured.magnification_m;
  measured_m_[kFocus] = measured.focus_m;
  optics_m_[kMagnification] = optics.magnification_m;
  optics_m_[kFocus] = optics.focus_m;
  for (const std::size_t axis : kBothAxes) {
    if (control_.settled(axis)) orders_[axis].settled.store(orders_[axis].taken, std::memory_order_release);
    // Whoever homes anew is on its way to where it had arrived.
    if (control_.state() != AxesControl::State::kReady)
      orders_[axis].settled.store(kNone, std::memory_order_release);
  }
  state_.store(control_.state(), std::memory_order_release);
  steps_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace telekerf::imaging
