// SPDX-License-Identifier: Apache-2.0
// What the demo's streams carry, recorded from its lap in virtual time.
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/codec/codec_traces.h"

namespace telekerf::experiments {

/// Of `seconds` of the engaged demo (heart, shipped robots, thesis-constant network): the commanded
/// accelerations, the master's measured tool (what law local streams), the slave's measured tool, the
/// force on the slave's tool (free running: what friction and noise leave of it) and the hand's on the
/// master's. At 1 kHz; same seed, same numbers. Throws StartupError.
std::vector<SeededTrace> recorded_traces(double seconds, std::uint64_t seed);

/// About what the sensor's noise and step leave in a trace of unknown origin: from its third differences.
double noise_of(const codec::Trace& trace);

}  // namespace telekerf::experiments
