// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/concealment.h"

namespace telekerf::streaming {

void conceal_gap(JitterBuffer& buffer, std::int64_t index, double period_s, int reach,
                 double max_m_per_s2) noexcept {
  const auto known = [&](std::int64_t at) {
    const StreamSample* sample = buffer.find(at);
    return sample != nullptr && !sample->concealed;
  };
  std::int64_t before = index;
  while (!known(before) && index - before < reach) --before;
  std::int64_t after = index;
  while (!known(after) && after - before <= reach) ++after;
  if (!known(before) || !known(after)) return;
  const StreamSample from = *buffer.find(before);
  const StreamSample to = *buffer.find(after);
  if (!from.engaged || !to.engaged || from.generation != to.generation || from.law != to.law ||
      from.engage != to.engage)
    return;

  const double duration = static_cast<double>(after - before) * period_s;
  const Vec3 way = (to.value - from.value) / duration;
  // p(u) = p0 + T (v0 u + b u^2 + c u^3); its acceleration is largest at an end.
  const Vec3 b = 3.0 * way - 2.0 * from.velocity_m_per_s - to.velocity_m_per_s;
  const Vec3 c = from.velocity_m_per_s + to.velocity_m_per_s - 2.0 * way;
  const double limit = max_m_per_s2 * duration;
  const bool bare = from.law == Law::kRemoteAcceleration;  // no states, nothing but accelerations
  if (!bare && (!((2.0 * b).norm() <= limit) || !((2.0 * b + 6.0 * c).norm() <= limit))) return;
  for (std::int64_t at = before + 1; at < after; ++at) {
    const double u = static_cast<double>(at - before) * period_s / duration;
    StreamSample sample = from;
    sample.concealed = true;
    sample.button = false;
    if (bare) {
      sample.acceleration_m_per_s2 += u * (to.acceleration_m_per_s2 - from.acceleration_m_per_s2);
    } else {
      sample.value += duration * u * (from.velocity_m_per_s + u * (b + u * c));
      sample.velocity_m_per_s += u * (2.0 * b + 3.0 * u * c);
      sample.acceleration_m_per_s2 = (2.0 * b + 6.0 * u * c) / duration;
    }
    buffer.store(at, sample);
  }
}

}  // namespace telekerf::streaming
