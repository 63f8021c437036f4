// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/trace_checks.h"

#include <algorithm>

#include "netem/core/trace.h"

namespace telekerf::netem {
namespace {

/// What was recorded at times of the profile; packets are asked for in the order of their times.
class Expected {
 public:
  explicit Expected(const DirectionProfile& profile)
      : recording_(*profile.recording),
        repeats_(profile.trace_end == TraceEnd::kRepeat),
        length_ns_(recording_length_ns(recording_)) {}

  /// Null: the recording is over.
  const RecordedOutcome* at(std::int64_t since_ns) {
    if (since_ns >= length_ns_ && !repeats_) return nullptr;
    const std::int64_t in_round_ns = since_ns % length_ns_;
    const auto same = std::equal_range(
        recording_.begin(), recording_.end(), RecordedOutcome{in_round_ns},
        [](const RecordedOutcome& a, const RecordedOutcome& b) { return a.in_ns < b.in_ns; });
    repeated_ = since_ns == last_ns_ ? repeated_ + 1 : 0;  // packets of one instant, one after the other
    last_ns_ = since_ns;
    if (same.second - same.first > repeated_) return &*(same.first + repeated_);
    return same.second == recording_.begin() ? &recording_.front() : &*(same.second - 1);
  }

 private:
  const Recording& recording_;
  bool repeats_;
  std::int64_t length_ns_;
  std::int64_t last_ns_ = -1;
  std::ptrdiff_t repeated_ = 0;
};

}  // namespace

void check_recording(const DirectionProfile& nominal, const Run& run, Checks& checks) {
  Expected expected(nominal);
  std::uint64_t differing = 0;
  std::uint64_t after = 0;
  for (const Sent& sent : run.sent) {
    const PacketOutcome& outcome = sent.outcome;
    const RecordedOutcome* const recorded = expected.at(sent.in_ns);
    after += recorded == nullptr;
    if (recorded == nullptr || recorded->lost) {
      differing += !outcome.lost();
      continue;
    }
    differing += outcome.lost() || outcome.due_ns - sent.in_ns != recorded->delay_ns ||
                 outcome.duplicated != recorded->duplicated || outcome.corrupted != recorded->corrupted;
  }
  checks.none("other than recorded", differing);
  checks.note("sent after the recording's end", "packets", static_cast<double>(after));
}

void check_loss_trace(const DirectionProfile& nominal, const Run& run, Checks& checks) {
  Expected expected(nominal);
  std::uint64_t differing = 0;
  for (const Sent& sent : run.sent) {
    const PacketOutcome& outcome = sent.outcome;
    const bool lost = outcome.lost_by_model || outcome.retransmissions > 0 || outcome.after_trace;
    const RecordedOutcome* const recorded = expected.at(sent.in_ns);
    differing += lost != (recorded == nullptr || recorded->lost);
  }
  checks.none("lost otherwise than recorded", differing);
}

}  // namespace telekerf::netem
