// SPDX-License-Identifier: Apache-2.0
#include "netem/core/bottleneck.h"

#include <algorithm>
#include <cmath>

#include "netem/core/delay_table.h"

namespace telekerf::netem {

Bottleneck::Bottleneck(const DirectionProfile& profile)
    : opportunities_(profile.rate_trace), repeats_(profile.trace_end == TraceEnd::kRepeat) {
  if (opportunities_) return;
  bool any = false;
  for (const Stage& stage : profile.stages) {
    const double rate = stage.conditions.rate_bit_per_s;
    const double ns_per_byte = rate > 0 ? 8e9 / rate : 0.0;
    any = any || rate > 0;
    if (rates_.empty() || rates_.back().ns_per_byte != ns_per_byte)
      rates_.push_back({std::llround(stage.from_s * 1e9), ns_per_byte});
  }
  if (!any) rates_.clear();
}

double Bottleneck::served_bytes(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
  if (opportunities_) {
    return static_cast<double>((opportunities_before(to_ns) - opportunities_before(from_ns)) *
                               kOpportunity_bytes);
  }
  double bytes = 0.0;
  for (std::size_t i = rate_at(from_ns); i < rates_.size() && from_ns < to_ns; ++i) {
    const std::int64_t end_ns = i + 1 < rates_.size() ? std::min(to_ns, rates_[i + 1].from_ns) : to_ns;
    if (rates_[i].ns_per_byte == 0) return std::numeric_limits<double>::infinity();
    bytes += static_cast<double>(end_ns - from_ns) / rates_[i].ns_per_byte;
    from_ns = end_ns;
  }
  return bytes;
}

std::int64_t Bottleneck::served_at(std::int64_t from_ns, double bytes) const noexcept {
  if (bytes <= 0) return from_ns;
  if (opportunities_) {
    const auto count = static_cast<std::int64_t>(opportunities_->at_ns.size());
    const auto needed = static_cast<std::int64_t>(std::ceil(bytes / kOpportunity_bytes));
    const std::int64_t last = opportunities_before(from_ns) + needed - 1;
    if (last >= count && !repeats_) return kNever;
    const std::int64_t round_ns = last / count * opportunities_->at_ns.back();
    return std::max(from_ns, round_ns + opportunities_->at_ns[static_cast<std::size_t>(last % count)]);
  }
  for (std::size_t i = rate_at(from_ns); i < rates_.size(); ++i) {
    const double ns_per_byte = rates_[i].ns_per_byte;
    if (ns_per_byte == 0) return from_ns;
    const double takes_ns = bytes * ns_per_byte;
    if (i + 1 == rates_.size() || takes_ns <= static_cast<double>(rates_[i + 1].from_ns - from_ns))
      return from_ns + rounded(takes_ns);
    bytes -= static_cast<double>(rates_[i + 1].from_ns - from_ns) / ns_per_byte;
    from_ns = rates_[i + 1].from_ns;
  }
  return from_ns;
}

std::size_t Bottleneck::rate_at(std::int64_t ns) const noexcept {
  const auto later = std::upper_bound(rates_.begin(), rates_.end(), ns,
                                      [](std::int64_t at, const Rate& rate) { return at < rate.from_ns; });
  return later == rates_.begin() ? 0 : static_cast<std::size_t>(later - rates_.begin()) - 1;
}

std::int64_t Bottleneck::opportunities_before(std::int64_t ns) const noexcept {
  const std::vector<std::int64_t>& at_ns = opportunities_->at_ns;
  std::int64_t rounds = 0;
  if (repeats_ && ns > 0) {
    rounds = (ns - 1) / at_ns.back();
    ns -= rounds * at_ns.back();
  }
  const auto before = std::lower_bound(at_ns.begin(), at_ns.end(), ns) - at_ns.begin();
  return rounds * static_cast<std::int64_t>(at_ns.size()) + before;
}

}  // namespace telekerf::netem
