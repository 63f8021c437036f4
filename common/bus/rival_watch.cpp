// SPDX-License-Identifier: Apache-2.0
#include "common/bus/rival_watch.h"

namespace telekerf {
namespace {

/// Until then states have come that tell whom the slave obeys.
constexpr std::chrono::milliseconds kJudged{1500};
/// A slave that was heard before speaks again until then, if it is there.
constexpr std::chrono::seconds kSpeaksAgain{5};
/// A loop that has not turned for so long was suspended, and knows nothing of today.
constexpr std::chrono::milliseconds kTurns{500};

}  // namespace

RivalWatch::Verdict RivalWatch::judge(Obeyed obeyed, bool second, std::chrono::nanoseconds seen) noexcept {
  if (seen < kJudged || (obeyed == Obeyed::kUnheard && seen < kSpeaksAgain)) return Verdict::kWaits;
  const bool nobody = obeyed == Obeyed::kNobody || obeyed == Obeyed::kUnheard;
  return obeyed == Obeyed::kUs || (nobody && !second) ? Verdict::kStays : Verdict::kGivesWay;
}

void RivalWatch::look() {
  const auto rival = bus_.rival();
  const auto now = std::chrono::steady_clock::now();
  if (!rival) {
    since_.reset();
    said_ = false;
    return;
  }
  const bool turns = now.time_since_epoch() - stepped_.load(std::memory_order_relaxed) < kTurns;
  if (!since_ || !turns) since_ = now;
  const Verdict verdict =
      judge(obeyed_.load(std::memory_order_relaxed), rival->we_come_second, now - *since_);
  if (verdict == Verdict::kGivesWay) {
    const std::lock_guard lock(mutex_);
    sentence_ = rival->sentence + "; this one gives way";
    gives_way_.store(true, std::memory_order_release);
  } else if (verdict == Verdict::kStays && !said_) {
    said_ = true;
    status_.say(rival->sentence + "; this one stays");
  }
}

std::string RivalWatch::sentence() const {
  const std::lock_guard lock(mutex_);
  return sentence_;
}

}  // namespace telekerf
