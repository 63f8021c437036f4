// SPDX-License-Identifier: Apache-2.0
// What becomes of packets at 1 kHz, as the file of a recorded trace, and its fingerprint.
#pragma once

#include <string>

#include "netem/core/emulator.h"
#include "netem/core/trace.h"

namespace telekerf::netem {

inline Recording record(const DirectionProfile& profile, const StreamKey& key, int packets) {
  Emulator emulator(profile, key, {1U << 16, 0, 0});
  Recording recording;
  for (int i = 0; i < packets; ++i) {
    const std::int64_t now_ns = i * std::int64_t{1'000'000};
    while (emulator.pop(now_ns)) {
    }
    const PacketOutcome outcome = emulator.push(now_ns, 200U, i);
    recording.push_back({now_ns, outcome.lost() ? 0 : outcome.due_ns - now_ns, outcome.lost(),
                         outcome.duplicated, outcome.corrupted});
  }
  return recording;
}

inline std::string text_of(const Recording& recording) {
  std::string text = std::string(kTraceHeader) + "\n";
  for (std::size_t i = 0; i < recording.size(); ++i) text += trace_row(i, recording[i]) + "\n";
  return text;
}

inline std::uint64_t fingerprint(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace telekerf::netem
