// SPDX-License-Identifier: Apache-2.0
#include "common/bus/stop_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "common/bus/kept_file.h"
#include "common/runtime/say.h"
#include "common/runtime/settings.h"

namespace telekerf {
namespace {

/// As the control loop's: a stop is answered a step after it is obeyed.
constexpr std::chrono::milliseconds kPeriod{1};
constexpr std::chrono::milliseconds kSettle{10};

}  // namespace

void StopFlags::add_parameters(Settings& settings) {
  settings.add("stop_file", stop_file, kept_file_form(), "keeps an emergency stop over a restart of this process");
}

std::string StopFlags::path(const BusSettings& bus) const {
  return path_of({.chosen = stop_file, .flag = "--stop-file", .what = "an emergency stop", .ending = ".stop"}, bus);
}

StopLine::StopLine(Bus& bus, std::string path)
    : file_(std::move(path)),
      latch_(file_.found()),
      epoch_(bus.settings().epoch),
      answers_(epoch_),
      kept_(latch_.text()),
      writer_(bus),
      reader_(bus, [this](const StopMessage& message) { hear(message); }) {
  order_from_latch();
  thread_ = std::jthread([this](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(kPeriod)) publish();
  });
  // A disk that takes its time delays no answer, and no further stop.
  settler_ = std::jthread([this](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(kSettle))
      if (unsettled_.exchange(false)) file_.settle();
  });
}

StopOrder StopLine::order() const noexcept {
  StopOrder order{.number = number_.load(std::memory_order_acquire), .cleared = {}};
  for (std::size_t n = 0; n < cleared_.size(); ++n)
    order.cleared[n] = cleared_[n].load(std::memory_order_relaxed);
  return order;
}

void StopLine::order_from_latch() noexcept {
  // A number that is neither in force nor cleared yet would stop once more: cleared ones first.
  const StopOrder order = latch_.order();
  for (std::size_t n = 0; n < cleared_.size(); ++n)
    cleared_[n].store(order.cleared[n], std::memory_order_relaxed);
  number_.store(order.number, std::memory_order_release);
}

std::string StopLine::sentence() const {
  const std::lock_guard lock(mutex_);
  if (latch_.in_force().empty()) return {};
  const StopLatch::Entry& entry = latch_.in_force().back();
  return fmt::format("stopped by {}{}{}: laser off until {} clears it (telekerf-ctl clear-stop)",
                     entry.source.empty() ? "the other side" : entry.source, entry.reason.empty() ? "" : ", ",
                     entry.reason, entry.source.empty() ? "who stopped" : entry.source);
}

void StopLine::hear(const StopMessage& message) {
  const std::lock_guard lock(mutex_);
  (void)latch_.hear(message);
  answers_.asked(message);
  order_from_latch();
}

void StopLine::publish() {
  const std::uint32_t obeyed = obeyed_.load(std::memory_order_acquire);
  const bool said = said_.exchange(false, std::memory_order_acq_rel);
  // Said without the lock: a reader of this process may be given it in this thread, whose own lock hear() is
  // called under.
  for (const StopMessage& answer : answers(said, obeyed)) (void)writer_.write(answer);
}

std::vector<StopMessage> StopLine::answers(bool said, std::uint32_t obeyed) {
  const std::lock_guard lock(mutex_);
  if (said) stop_here();
  if (obeyed != 0) (void)latch_.quoted(obeyed);  // known already, unless only the stream has brought it
  order_from_latch();
  if (latch_.text() != kept_) keep();
  return answers_.take(latch_, obeyed);
}

void StopLine::stop_here() {
  const auto& stops = latch_.in_force();
  if (std::any_of(stops.begin(), stops.end(), [](const auto& stop) { return stop.source == kDevice; }))
    return;
  // The answer that the loop obeys it, and the number in the stream, tell it to everyone else.
  (void)latch_.hear({.epoch = epoch_,
                     .number = any_stop_number(),
                     .source = kDevice,
                     .set = true,
                     .obeyed = false,
                     .reason = "squeezed"});
}

void StopLine::keep() {
  kept_ = latch_.text();
  if (const std::string obstacle = file_.keep(kept_); !obstacle.empty())
    write_line(stderr, fmt::format("an emergency stop cannot be kept over a restart: {}: {}", file_.path(),
                                   obstacle));
  unsettled_.store(true);
}

}  // namespace telekerf
