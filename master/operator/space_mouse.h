// SPDX-License-Identifier: Apache-2.0
// The cap of a SpaceMouse (3Dconnexion) as the kernel tells of it. Pushed off its middle it pulls the tool
// that way, the harder the further. No device, no clock of its own.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/runtime/vectors.h"
#include "master/operator/operator_lease.h"

namespace telekerf::master {

/// A cap counts to about 350 each way.
struct SpaceMouseSettings {
  double mm_per_count = 0.007;  ///< how far in front of the tool it pulls, on the contour as it was published
  int dead_counts = 20;         ///< a cap at rest is not quite in its middle
};

/// Neither allocates nor throws. A device that falls silent has let go.
///
/// Newer kernels tell the axes as EV_ABS, with a zero at rest: after a silence while it was pushed, and where
/// it is pushed at the beginning, it has to come to rest once before it pulls again. Older ones tell them as
/// EV_REL, which has no zero: rest is silence, and an axis that a report leaves out is at rest.
class SpaceMouseCap {
 public:
  static constexpr std::int64_t kSilence_ns = OperatorLease::kSilence_ns;

  SpaceMouseCap(const SpaceMouseSettings& settings, bool relative) noexcept
      : settings_(settings), relative_(relative) {}

  /// One event; type and code by the kernel's numbers. What is none of its axes changes nothing.
  void hear(int type, int code, int value) noexcept;
  /// Events were lost: it counts after it was at rest.
  void lose() noexcept { let_go_ = false; }
  /// Every control step, `now_ns` on the monotonic clock: from the tool to where it pulls, m, x right and y
  /// away from the operator. None: it is at rest, silent, or has to come to rest first.
  std::optional<Vec2> pull_m(std::int64_t now_ns) noexcept;

 private:
  SpaceMouseSettings settings_;
  bool relative_;
  Vec2 counts_ = Vec2::Zero();    ///< right, towards the operator
  Vec2 reported_ = Vec2::Zero();  ///< of the report that is being heard
  bool moved_ = false;            ///< that report tells of a translation
  bool heard_ = false;            ///< a report has come since the last step
  std::int64_t heard_ns_ = std::numeric_limits<std::int64_t>::min() / 2;  ///< never
  bool let_go_ = false;
};

}  // namespace telekerf::master
