// SPDX-License-Identifier: Apache-2.0
#include "netem/core/compiled_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "netem/core/trace.h"

namespace telekerf::netem {
namespace {

std::int64_t to_ns(double s) { return std::llround(s * 1e9); }

std::array<Probability, kMaxLossStates - 1> cumulative(
    const std::array<double, kMaxLossStates>& probabilities) {
  std::array<Probability, kMaxLossStates - 1> up_to;
  double sum = 0.0;
  for (int i = 0; i < kMaxLossStates - 1; ++i) {
    sum += probabilities[i];
    up_to[i] = Probability(std::clamp(sum, 0.0, 1.0));  // what is left of 1 may be a rounding below 0
  }
  return up_to;
}

}  // namespace

CompiledProfile::Stage::Stage(const netem::Stage& stage, std::shared_ptr<const DelayTable> table)
    : from_ns(to_ns(stage.from_s)),
      delay(std::move(table)),
      constant(stage.conditions.delay.distribution == DelayDistribution::kConstant),
      constant_ns(to_ns(stage.conditions.delay.delay_s)),
      correlation_ns(stage.conditions.delay.correlation_s * 1e9),
      mean_loss(stage.conditions.loss.loss),
      burst_memory_ns(burst_memory_s(stage.conditions.loss) * 1e9),
      order(stage.conditions.order),
      reorder(stage.conditions.reorder),
      reorder_gap(static_cast<std::uint32_t>(stage.conditions.reorder_gap)),
      tcp_like(stage.conditions.tcp_like),
      rto_ns(to_ns(stage.conditions.rto_s)),
      duplicate(stage.conditions.duplicate),
      corrupt(stage.conditions.corrupt),
      queue_bytes(static_cast<double>(stage.conditions.queue_bytes)),
      slot_ns(to_ns(stage.conditions.slots.period_s)),
      slot_jitter_ns(to_ns(stage.conditions.slots.jitter_s)),
      slot_packets(stage.conditions.slots.packets),
      slot_bytes(stage.conditions.slots.bytes) {
  const Conditions& now = stage.conditions;
  const LossChain chain = loss_chain(now.loss, 0.0);
  lossy = netem::mean_loss(chain) > 0;
  has_states = chain.states > 1;
  loss_from_trace = now.loss.model == LossModel::kTrace;
  retransmission_lost = Probability(netem::mean_loss(chain));
  first_state = cumulative(chain.stationary);
  for (int i = 0; i < kMaxLossStates; ++i) loss[i] = {cumulative(chain.to[i]), Probability(chain.lost[i])};
}

CompiledProfile::Event::Event(const netem::Event& event)
    : first_ns(to_ns(event.first_s)),
      every_ns(to_ns(event.every_s)),
      duration_ns(to_ns(event.duration_s)),
      add_min_ns(to_ns(event.add_delay_min_s)),
      add_range_ns(to_ns(event.add_delay_max_s) - add_min_ns),
      lost(event.loss),
      hold(event.hold),
      coupling(event.coupling) {}

CompiledProfile::Window CompiledProfile::Event::window(std::int64_t since_ns) const noexcept {
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  const std::int64_t after_ns = since_ns - first_ns;
  if (after_ns < 0) return {std::numeric_limits<std::int64_t>::min(), first_ns, -1};
  const std::int64_t count = every_ns == 0 ? 0 : after_ns / every_ns;
  const std::int64_t begin_ns = first_ns + count * every_ns;
  if (since_ns < begin_ns + duration_ns) return {begin_ns, begin_ns + duration_ns, count};
  return {begin_ns + duration_ns, every_ns == 0 ? kNever : begin_ns + every_ns, -1};
}

CompiledProfile::CompiledProfile(const DirectionProfile& profile)
    : bottleneck(profile),
      recording(profile.recording),
      loss_only(profile.loss_only),
      repeats(profile.trace_end == TraceEnd::kRepeat) {
  std::shared_ptr<const DelayTable> table;
  const DelayParameters* law = nullptr;
  for (const auto& stage : profile.stages) {
    if (law == nullptr || stage.conditions.delay != *law)
      table = std::make_shared<DelayTable>(stage.conditions.delay);
    law = &stage.conditions.delay;
    stages.emplace_back(stage, table);
  }
  for (const auto& event : profile.events) events.emplace_back(event);
  if (recording) recording_ns = recording_length_ns(*recording);
}

}  // namespace telekerf::netem
