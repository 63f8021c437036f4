// SPDX-License-Identifier: Apache-2.0
#include "master/operator/space_mouse.h"

#include <linux/input-event-codes.h>

namespace telekerf::master {

void SpaceMouseCap::hear(int type, int code, int value) noexcept {
  if (type == EV_ABS && !relative_ && code >= ABS_X && code <= ABS_RZ) {
    heard_ = true;  // any axis: a cap that is held still trembles in one of the six
    if (code == ABS_X) counts_.x() = value;
    if (code == ABS_Y) counts_.y() = value;
    return;
  }
  if (!relative_) return;
  // Translation and rotation come in reports of their own.
  if (type == EV_REL && code >= REL_X && code <= REL_Z) {
    moved_ = true;
    if (code == REL_X) reported_.x() = value;
    if (code == REL_Y) reported_.y() = value;
  }
  if (type == EV_SYN && code == SYN_REPORT && moved_) {
    heard_ = true;
    counts_ = reported_;
    reported_.setZero();
    moved_ = false;
  }
}

std::optional<Vec2> SpaceMouseCap::pull_m(std::int64_t now_ns) noexcept {
  if (heard_) heard_ns_ = now_ns;
  heard_ = false;
  const bool silent = now_ns - heard_ns_ >= kSilence_ns;
  if (silent && relative_) counts_.setZero();
  const double pushed = counts_.norm() - settings_.dead_counts;
  if (pushed <= 0.0) {
    let_go_ = true;
    return std::nullopt;
  }
  if (silent) let_go_ = false;
  if (!let_go_) return std::nullopt;
  // The kernel counts y towards the operator.
  const Vec2 direction = Vec2(counts_.x(), -counts_.y()) / counts_.norm();
  return 1e-3 * settings_.mm_per_count * pushed * direction;
}

}  // namespace telekerf::master
