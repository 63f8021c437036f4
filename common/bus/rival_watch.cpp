// SPDX-License-Identifier: Apache-2.0
#include "common/bus/rival_watch.h"

namespace telekerf {
namespace {

/// Until then states have come that tell whom the slave obeys.
constexpr std::chrono::milliseconds kJudged{1500};

}  // namespace

void RivalWatch::look() {
  const auto rival = bus_.rival();
  const auto now = std::chrono::steady_clock::now();
  if (!rival) {
    since_.reset();
    said_ = false;
    return;
  }
  if (!since_) since_ = now;
  if (now - *since_ < kJudged) return;
  const Obeyed obeyed = obeyed_.load(std::memory_order_relaxed);
  const bool stays = obeyed == Obeyed::kUs || (obeyed == Obeyed::kNobody && !rival->we_come_second);
  if (!stays) {
    const std::lock_guard lock(mutex_);
    sentence_ = rival->sentence + "; this one gives way";
    gives_way_.store(true, std::memory_order_release);
  } else if (!said_) {
    said_ = true;
    status_.say(rival->sentence + "; this one stays");
  }
}

std::string RivalWatch::sentence() const {
  const std::lock_guard lock(mutex_);
  return sentence_;
}

}  // namespace telekerf
