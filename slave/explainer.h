// SPDX-License-Identifier: Apache-2.0
// While a slave is led: once a second, in words, why the beam is off and why the tool does not follow.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "common/runtime/status_reporter.h"
#include "slave/explanation.h"

namespace telekerf::slave {

/// What is said once a second of a beam that is off and a tool that does not follow, for the one who watches.
class Explainer {
 public:
  explicit Explainer(StatusReporter& status)
      : thread_([this, &status](const std::stop_token& stop) { run(stop, status); }) {}
  /// Every control step: wait-free.
  void step(const SlaveOutputs& out) noexcept {
    const bool lit = out.laser_w > 0.0;
    const bool led = out.reason != HoldReason::kNotEngaged && out.reason != HoldReason::kNoCommands;
    now_.store(std::uint64_t{out.forbidden} << 32U | static_cast<unsigned>(out.reason) << 16U |
                   static_cast<unsigned>(out.mode) << 8U | (led ? 8U : 0U) | (out.settled ? 4U : 0U) |
                   (out.button ? 2U : 0U) | (lit ? 1U : 0U),
               std::memory_order_relaxed);
  }

 private:
  void run(const std::stop_token& stop, StatusReporter& status) {
    std::string said;
    std::uint32_t before = 0;  ///< what forbade a second ago
    bool dark = true;          ///< as far as has been said
    for (int n = 0; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      if (++n % 20 != 0) continue;
      const std::uint64_t now = now_.load(std::memory_order_relaxed);
      if ((now & 8U) == 0) continue;  // nobody wants anything
      SlaveOutputs out;
      out.forbidden = static_cast<std::uint32_t>(now >> 32U);
      out.reason = static_cast<HoldReason>(now >> 16U & 0xFFU);
      out.mode = static_cast<SlaveMode>(now >> 8U & 0xFFU);
      out.settled = (now & 4U) != 0;
      out.button = (now & 2U) != 0;
      out.laser_w = (now & 1U) != 0 ? 1.0 : 0.0;
      const bool lit = out.laser_w > 0.0;
      // A beam that nobody asks for needs no word, unless nobody could have it.
      const std::uint32_t lasting = out.forbidden & before & ~kButtonGuard;
      before = out.forbidden;
      const bool missed =
          lasting != 0 || (out.forbidden != 0 && (out.button || out.mode != SlaveMode::kFollowing));
      if (!missed && !(lit && dark)) continue;
      dark = !lit;
      std::string sentence = explanation(out);
      if (sentence != said) status.say(sentence);
      said = std::move(sentence);
    }
  }

  std::atomic<std::uint64_t> now_{0};
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf::slave
