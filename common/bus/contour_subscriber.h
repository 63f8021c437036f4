// SPDX-License-Identifier: Apache-2.0
// Prepares each newly published contour outside the control loop and hands it over by pointer.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/endpoints.h"
#include "common/bus/event_answers.h"
#include "common/bus/handover.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// As people tell it from another one: number, source, length and size.
std::string title_of(const ContourMessage& message);

/// Whether an answer to an operator's wish says that its sender, another process than one of `own_role`, does
/// not take the contour `id`.
bool refuses_contour(const EventMessage& answer, const std::string& own_role, std::uint32_t id);

/// `Prepared` is what a node needs of a contour (a guide, a corridor). The first contour that fits is in
/// force at once. Another one than that waits until an operator takes it (EventMessage::Kind::kTakeContour);
/// of several the last one waits. One that does not fit (prepare() throws a StartupError) is refused with its
/// sentence and counted, and what is in force stays; so is one whose id is not its digest. The contour in
/// force, published again, changes nothing.
///
/// Two sides take a contour together or not at all: where another process answers the same operator that it
/// does not take it, the one before is in force again here, too.
template <class Prepared>
class ContourSubscriber {
 public:
  using Prepare = std::function<std::unique_ptr<Prepared>(const ContourMessage&)>;

  /// Who takes another contour answers whoever has asked for it; who looks on does not.
  enum class Part { kTakes, kLooksOn };
  ContourSubscriber(Bus& bus, Prepare prepare, Part part = Part::kTakes)
      : role_(bus.settings().role), reader_(bus, kAtOnce), events_(bus), prepare_(std::move(prepare)) {
    if (part == Part::kTakes) answers_.emplace(bus);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  /// The contour in force as prepared last, null before the first. For one thread, the control loop's, once a
  /// step: wait-free. What an earlier step got may be freed after the step that got another one (Handover).
  Prepared* current() noexcept { return prepared_.current(); }
  /// True as long as none is in force and the newest that came does not fit; `refusal()` says why.
  bool refused() const noexcept { return refused_.load(std::memory_order_acquire); }
  std::string refusal() const {
    const std::lock_guard lock(mutex_);
    return refusal_;
  }
  /// Contours that were refused.
  std::uint64_t unfit() const noexcept { return unfit_.load(std::memory_order_relaxed); }
  /// Prepares the newest contour once more, for what has changed in its preparation, be it in force or
  /// refused. Wait-free. If it is refused now, what was in force stays, and the refusal's sentence goes to
  /// stderr.
  void request_rebuild() noexcept { rebuild_.store(true, std::memory_order_release); }
  /// The message that was prepared last: the one behind current(), or behind what current() will give next.
  ContourMessage message() const {
    const std::lock_guard lock(mutex_);
    return message_;
  }
  /// Those that have been in force, in order; of very many the last ones.
  std::vector<ContourMessage> adopted() const {
    const std::lock_guard lock(mutex_);
    return adopted_;
  }

 private:
  void run(const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kNap{10};
    constexpr std::chrono::milliseconds kPace{100};  // whoever publishes oftener is not looked at oftener
    std::optional<ContourMessage> newest;
    for (auto next = Clock::now(); !stop.stop_requested(); std::this_thread::sleep_for(kNap)) {
      while (auto received = reader_.take()) newest = std::move(received->value);
      if (newest && Clock::now() >= next) {
        next = Clock::now() + kPace;
        consider(std::move(*newest));
        newest.reset();
      }
      while (const auto event = events_.take()) {
        if (event->value.kind == EventMessage::Kind::kAnswer) hear(event->value);
        if (event->value.kind != EventMessage::Kind::kTakeContour) continue;
        const std::string refusal = take(event->value.value, event->value.epoch);
        if (answers_) answers_->give(event->value.epoch, refusal);
      }
      if (answers_) answers_->again();
      if (rebuild_.exchange(false, std::memory_order_acq_rel)) rebuild();
      prepared_.collect();
    }
  }
  void consider(ContourMessage message) {
    if (message.id != digest_of(message)) return refuse(message, "its id is not the digest of its points");
    if ((any_ && message.id == message_.id) || (waiting_ && message.id == waiting_->id)) return;
    if (!any_) return begin(std::move(message));
    write_line(stdout,
               fmt::format("{}: {} has come and waits; {} stays in force unless it is told: telekerf-ctl "
                           "take-contour {}",
                           role_, title_of(message), title_of(message_), message.id));
    waiting_ = std::move(message);
  }
  /// None is in force yet. One that does not fit waits for another preparation.
  void begin(ContourMessage message) {
    try {
      adopt(message);
      // After a restart it may be another one than before, which an operator had not taken yet.
      if (answers_) write_line(stdout, fmt::format("{}: works on {}", role_, title_of(message)));
    } catch (const StartupError& refusal) {
      refuse(message, refusal.what());
      waiting_ = std::move(message);
      const std::lock_guard lock(mutex_);
      refusal_ = refusal.what();
      refused_.store(true, std::memory_order_release);
    }
  }
  /// Why nothing comes of it; empty: it is done. `asker`: start of the process that asks.
  std::string take(double id, std::uint32_t asker) {
    if (any_ && message_.id == id) return {};
    if (!waiting_ || waiting_->id != id)
      return fmt::format("no contour {:.0f} waits here{}", id,
                         waiting_ ? fmt::format(", but {}", title_of(*waiting_)) : std::string());
    const ContourMessage message = std::move(*waiting_);
    waiting_.reset();
    std::optional<ContourMessage> before;
    if (any_) before = message_;
    try {
      adopt(message);
      taken_ = {asker, Clock::now(), std::move(before)};
    } catch (const StartupError& refusal) {
      refuse(message, refusal.what());
      return fmt::format("{} refused: {}", title_of(message), refusal.what());
    }
    write_line(stdout, fmt::format("{}: {} is in force now", role_, title_of(message)));
    return {};
  }
  /// Of another process, to whoever has asked this one, too.
  void hear(const EventMessage& answer) {
    constexpr std::chrono::seconds kAnswered{10};
    if (!taken_ || answer.epoch != taken_->asker || !refuses_contour(answer, role_, message_.id)) return;
    const auto taken = *std::exchange(taken_, std::nullopt);
    if (!taken.before || Clock::now() - taken.when > kAnswered) return;
    const std::string refused = title_of(message_);
    try {
      adopt(*taken.before);
      unfit_.fetch_add(1, std::memory_order_relaxed);
      write_line(stderr, fmt::format("{}: {} is not taken by both sides ({}); {} is in force again", role_,
                                     refused, answer.text, title_of(message_)));
    } catch (const StartupError& refusal) {
      write_line(stderr,
                 fmt::format("{}: {} is not taken by both sides ({}), and the one before does not fit any "
                             "more: {}",
                             role_, refused, answer.text, refusal.what()));
    }
  }
  /// Throws StartupError.
  void adopt(const ContourMessage& message) {
    auto prepared = prepare_(message);
    {
      const std::lock_guard lock(mutex_);
      message_ = message;
      constexpr std::size_t kMost = 16;
      if (adopted_.size() == kMost) adopted_.erase(adopted_.begin());
      adopted_.push_back(message);
    }
    prepared_.offer(std::move(prepared));
    if (!any_) waiting_.reset();
    any_ = true;
    refused_.store(false, std::memory_order_release);
  }
  void refuse(const ContourMessage& message, const char* why) {
    unfit_.fetch_add(1, std::memory_order_relaxed);
    write_line(stderr, fmt::format("{}: contour {} refused: {}", role_, message.source, why));
  }
  void rebuild() {
    if (!any_) {
      if (auto refused = std::exchange(waiting_, std::nullopt)) begin(std::move(*refused));
      return;
    }
    try {
      prepared_.offer(prepare_(message_));  // only this thread writes it
    } catch (const StartupError& refusal) {
      write_line(stderr, fmt::format("{}: stays as it is: {}", message_.source, refusal.what()));
    }
  }

  using Clock = std::chrono::steady_clock;
  /// That come within a nap: of more the newest would be lost, and it is the one that counts.
  static constexpr std::size_t kAtOnce = 256;

  std::string role_;
  Reader<ContourMessage> reader_;
  Reader<EventMessage> events_;
  std::optional<EventAnswers> answers_;
  Prepare prepare_;
  bool any_ = false;  ///< the thread's: a contour is in force
  std::optional<ContourMessage>
      waiting_;  ///< the thread's: for an operator, or refused while none is in force
  struct Taken {
    std::uint32_t asker;
    Clock::time_point when;
    std::optional<ContourMessage> before;  ///< in force until then
  };
  std::optional<Taken> taken_;  ///< the thread's: by the last operator who was obeyed
  Handover<Prepared> prepared_;
  mutable std::mutex mutex_;
  ContourMessage message_;
  std::vector<ContourMessage> adopted_;
  std::string refusal_;
  std::atomic<bool> refused_{false};
  std::atomic<std::uint64_t> unfit_{0};
  std::atomic<bool> rebuild_{false};
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
