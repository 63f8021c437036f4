// SPDX-License-Identifier: Apache-2.0
// What stands for samples that did not come in time.
#pragma once

#include <cstdint>

#include "common/streaming/jitter_buffer.h"

namespace telekerf::streaming {

/// Closes the gap around `index` of a stream of accelerations, where the samples on both sides are there,
/// engaged and of one generation: cubics through their states (of bare accelerations: straight lines), marked
/// as concealed. Nothing where the gap is longer than `reach` samples or the way over it would take more than
/// `max_m_per_s2`.
void conceal_gap(JitterBuffer& buffer, std::int64_t index, double period_s, int reach,
                 double max_m_per_s2) noexcept;

}  // namespace telekerf::streaming
