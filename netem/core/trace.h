// SPDX-License-Identifier: Apache-2.0
// A trace holds the outcome of every packet: CSV `index,in_ns,out_ns,lost,duplicated,corrupted`, out_ns = -1
// if lost.
#pragma once

#include <string>

#include "netem/core/profile.h"

namespace telekerf::netem {

inline constexpr const char* kTraceHeader = "index,in_ns,out_ns,lost,duplicated,corrupted";

/// Throws StartupError naming file and line: missing file, wrong header, field or order (in_ns ascends,
/// out_ns >= in_ns).
Recording load_recording(const std::string& file);

/// How long it lasts: to its last packet, and as long again as packets lie apart on average.
std::int64_t recording_length_ns(const Recording& recording);

/// A file of mahimahi: one whole number a line, the millisecond of an opportunity; ascending, the last above
/// 0. Throws StartupError naming file and line.
RateTrace load_rate_trace(const std::string& file);

/// One CSV row, without the line's end.
std::string trace_row(std::uint64_t index, const RecordedOutcome& outcome);

}  // namespace telekerf::netem
