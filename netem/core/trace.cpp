// SPDX-License-Identifier: Apache-2.0
#include "netem/core/trace.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <string_view>

#include "common/runtime/startup_error.h"

namespace telekerf::netem {
namespace {

constexpr int kFields = 6;

/// Six integers, comma-separated, nothing else.
bool parse_row(std::string_view row, std::int64_t (&fields)[kFields]) {
  const char* at = row.data();
  const char* const end = row.data() + row.size();
  for (int i = 0; i < kFields; ++i) {
    const auto [next, error] = std::from_chars(at, end, fields[i]);
    if (error != std::errc()) return false;
    const bool last = i == kFields - 1;
    if (last ? next != end : (next == end || *next != ',')) return false;
    at = next + 1;
  }
  return true;
}

/// A line without its end, be it that of Unix or of Windows.
bool next_line(std::istream& in, std::string& line) {
  if (!std::getline(in, line)) return false;
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

bool is_flag(std::int64_t field) { return field == 0 || field == 1; }

}  // namespace

Recording load_recording(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw input_error(fmt::format("cannot open the trace '{}'", file));
  std::string line;
  if (!next_line(in, line) || line != kTraceHeader) {
    throw input_error(fmt::format("{}: line 1 must be '{}'", file, kTraceHeader));
  }
  Recording recording;
  for (int number = 2; next_line(in, line); ++number) {
    const auto refuse = [&](const char* complaint) {
      throw input_error(fmt::format("{}: line {} ('{}'): {}", file, number, line.substr(0, 80), complaint));
    };
    std::int64_t field[kFields];
    if (!parse_row(line, field)) refuse("needs six whole numbers");
    const bool lost = field[3] == 1;
    if (!is_flag(field[3]) || !is_flag(field[4]) || !is_flag(field[5])) refuse("flags must be 0 or 1");
    if (field[0] != static_cast<std::int64_t>(recording.size())) refuse("index must count up from 0");
    constexpr std::int64_t kLatest_ns = 1'000'000'000'000'000'000;  // thirty years
    if (field[1] < 0) refuse("in_ns must not be negative");
    if (field[1] > kLatest_ns || field[2] > kLatest_ns) refuse("in_ns and out_ns must not exceed 10^18");
    if (!lost && field[2] < field[1]) refuse("out_ns must not lie before in_ns");
    if (!recording.empty() && field[1] < recording.back().in_ns) refuse("in_ns must not go backwards");
    recording.push_back({field[1], lost ? 0 : field[2] - field[1], lost, field[4] == 1, field[5] == 1});
  }
  if (recording.empty()) throw input_error(fmt::format("{}: holds no packet", file));
  return recording;
}

std::int64_t recording_length_ns(const Recording& recording) {
  constexpr std::int64_t kShortest_ns = 1'000'000;
  const std::int64_t last_ns = recording.back().in_ns;
  const auto gaps = static_cast<std::int64_t>(recording.size()) - 1;
  const std::int64_t gap_ns = gaps == 0 ? 0 : (last_ns - recording.front().in_ns) / gaps;
  return last_ns + (gap_ns > 0 ? gap_ns : kShortest_ns);
}

RateTrace load_rate_trace(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw input_error(fmt::format("cannot open the recorded rate '{}'", file));
  constexpr std::int64_t kMillisecond_ns = 1'000'000;
  constexpr std::int64_t kLongest_ms = 1'000'000'000;  // eleven days
  RateTrace trace;
  std::string line;
  for (int number = 1; next_line(in, line); ++number) {
    const auto refuse = [&](const char* complaint) {
      throw input_error(fmt::format("{}: line {} ('{}'): {}", file, number, line.substr(0, 80), complaint));
    };
    std::int64_t ms = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), ms);
    if (error != std::errc() || end != line.data() + line.size())
      refuse("needs one whole number, the millisecond of an opportunity to send 1500 bytes");
    if (ms < 0 || ms > kLongest_ms) refuse("must lie within 0 and 1000000000 ms");
    if (!trace.at_ns.empty() && ms * kMillisecond_ns < trace.at_ns.back()) refuse("must not go backwards");
    trace.at_ns.push_back(ms * kMillisecond_ns);
  }
  if (trace.at_ns.empty() || trace.at_ns.back() == 0)
    throw input_error(fmt::format("{}: holds no opportunity after 0 ms", file));
  return trace;
}

std::string trace_row(std::uint64_t index, const RecordedOutcome& outcome) {
  return fmt::format("{},{},{},{:d},{:d},{:d}", index, outcome.in_ns,
                     outcome.lost ? -1 : outcome.in_ns + outcome.delay_ns, outcome.lost, outcome.duplicated,
                     outcome.corrupted);
}

}  // namespace telekerf::netem
