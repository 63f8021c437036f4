// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/stop_trial.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/protocol/stop_talk.h"
#include "experiments/draw.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr std::int64_t kStep_ns = 100'000;  ///< of what has no clock: arrivals
constexpr std::int64_t kAgain_ns = std::chrono::nanoseconds(kStopAgain).count();
constexpr std::int64_t kGivenUp_ns = 5'000'000'000;
constexpr std::uint32_t kNumber = 7;
constexpr std::uint32_t kBytes = 120;  ///< of a stop message on the wire, about

using Link = simulation::VirtualLink<StopMessage>;

Link link_of(const StopTrial& trial, netem::Direction direction) {
  netem::Stage stage;
  stage.conditions.delay.delay_s = 0.5 * trial.rtt_s;
  stage.conditions.loss.model = trial.loss > 0.0 ? netem::LossModel::kBernoulli : stage.conditions.loss.model;
  stage.conditions.loss.loss = trial.loss;
  netem::DirectionProfile profile;
  profile.stages = {stage};
  return {profile, trial.seed, direction};
}

/// The station at the far end.
class Station {
 public:
  explicit Station(const std::string& file = {}) : latch_(StopLatch::from_text(file)) {}
  void hear(const StopMessage& message) {
    (void)latch_.hear(message);
    answers_.asked(message);
  }
  void step() { obeyed_ = latch_.order().number; }
  std::vector<StopMessage> answers() { return answers_.take(latch_, obeyed_); }
  std::uint32_t obeyed() const { return obeyed_; }
  std::string file() const { return latch_.text(); }

 private:
  StopLatch latch_;
  StopReplies answers_{2};
  std::uint32_t obeyed_ = 0;
};

/// When the loop first obeyed and when the answer came.
StopOutcome insist(const StopTrial& trial, Station& station, bool set) {
  Draw draw(trial.seed + (set ? 0 : 1'000'000));
  Link forward = link_of(trial, netem::Direction::kForward);
  Link backward = link_of(trial, netem::Direction::kBackward);
  const auto phase = [&] { return static_cast<std::int64_t>(draw.between(0.0, 10.0)) * kStep_ns; };
  const std::int64_t loop_ns = phase(), thread_ns = phase();
  const StopMessage said{
      .epoch = 1, .number = kNumber, .source = "operator", .set = set, .obeyed = false, .reason = {}};
  StopOutcome out;
  std::vector<Received<StopMessage>> arrived;
  for (std::int64_t now_ns = 0; now_ns < kGivenUp_ns; now_ns += kStep_ns) {
    if (now_ns % kAgain_ns == 0) forward.push(now_ns, said, kBytes);
    arrived.clear();
    forward.deliver(now_ns, arrived);
    for (const auto& message : arrived) station.hear(message.value);
    if (now_ns % kTick_ns == loop_ns) station.step();
    if (out.obeyed_s < 0.0 && station.obeyed() == (set ? kNumber : 0))
      out.obeyed_s = static_cast<double>(now_ns) * 1e-9;
    if (now_ns % kTick_ns == thread_ns)
      for (const StopMessage& answer : station.answers()) backward.push(now_ns, answer, kBytes);
    arrived.clear();
    backward.deliver(now_ns, arrived);
    if (std::any_of(arrived.begin(), arrived.end(), [&](const auto& answer) {
          return answer.value.number == kNumber && answer.value.set == set;
        })) {
      out.acknowledged_s = static_cast<double>(now_ns) * 1e-9;
      return out;
    }
  }
  return out;
}

}  // namespace

StopOutcome try_stop(const StopTrial& trial) {
  Station station;
  StopOutcome out = insist(trial, station, true);
  Station again(station.file());
  again.step();
  const bool held = again.obeyed() == kNumber;
  const bool cleared = insist(trial, again, false).acknowledged_s >= 0.0;
  out.survived = held && cleared && Station(again.file()).file().empty();
  return out;
}

bool try_stops(std::uint64_t seed, int runs, nlohmann::ordered_json& out) {
  struct {
    double loss, most_s, over_rtt_s = 0.0;
  } conditions[] = {{0.0, 2e-3}, {0.2, 60e-3}};
  bool survived = true;
  for (auto& [loss, most_s, over_rtt_s] : conditions) {
    for (int n = 0; n < runs; ++n) {
      StopTrial trial{.seed = seed + static_cast<std::uint64_t>(n), .loss = loss};
      trial.rtt_s = Draw(trial.seed).factor(0.002, 0.15);
      const StopOutcome outcome = try_stop(trial);
      survived = survived && outcome.survived;
      over_rtt_s =
          std::max(over_rtt_s, outcome.acknowledged_s < 0.0 ? 1e9 : outcome.acknowledged_s - trial.rtt_s);
    }
  }
  out = {{"runs", runs},
         {"acknowledged_over_rtt_ms_max", 1e3 * conditions[0].over_rtt_s},
         {"acknowledged_over_rtt_ms_max_at_20_percent_loss", 1e3 * conditions[1].over_rtt_s},
         {"survived_restarts", survived}};
  return survived && std::all_of(std::begin(conditions), std::end(conditions), [](const auto& condition) {
           return condition.over_rtt_s <= condition.most_s;
         });
}

}  // namespace telekerf::experiments
