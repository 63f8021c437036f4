// SPDX-License-Identifier: Apache-2.0
#include "master/observer/network_observer.h"

#include <fmt/format.h>

#include "common/runtime/startup_error.h"

namespace telekerf::master {

const char* to_string(Estimator estimator) noexcept {
  switch (estimator) {
    case Estimator::kNone:
      return "none";
    case Estimator::kThesis:
      return "thesis";
    case Estimator::kDelayedInnovation:
      return "delayed-innovation";
    case Estimator::kPredictor:
      return "predictor";
  }
  return "unknown";
}

Estimator estimator_named(const std::string& name) {
  for (const auto estimator :
       {Estimator::kNone, Estimator::kThesis, Estimator::kDelayedInnovation, Estimator::kPredictor}) {
    if (name == to_string(estimator)) return estimator;
  }
  throw StartupError(
      fmt::format("estimator = '{}' must be one of none, thesis, delayed-innovation, predictor", name));
}

NetworkObserver::AnyEstimator NetworkObserver::make(Law law, const ObserverSettings& settings) {
  switch (settings.estimator) {
    case Estimator::kThesis:
      return CommunicationDisturbanceObserver(settings.thesis_cutoff_rad_s, settings.period_s);
    case Estimator::kDelayedInnovation:
      return DelayedInnovation(settings.innovation_gain_per_s, settings.period_s);
    case Estimator::kPredictor:
      // A slave that follows a reference is no open integrator: it is where the reference is.
      if (law != Law::kRemoteAcceleration) return ReferenceModelEstimator(settings.followed_gain);
      return PropagatedPredictor(settings.predictor_rad_s, settings.disturbance_rad_s, settings.period_s);
    case Estimator::kNone:
      break;
  }
  return NoPrediction{};
}

NetworkObserver::NetworkObserver(Law law, const ObserverSettings& settings)
    : period_s_(settings.period_s), estimator_(make(law, settings)) {}

void NetworkObserver::begin(std::int64_t index, const KinematicState& state) noexcept {
  next_ = index;
  std::visit([&](auto& estimator) { estimator.begin(index, state); }, estimator_);
}

void NetworkObserver::sent(std::int64_t index, const KinematicState& model, const Vec3& command) noexcept {
  KinematicState commanded = model;
  commanded.acceleration_m_per_s2 = command;
  ring_.store(index, commanded);
  std::visit([&](auto& estimator) { estimator.sent(ring_, index); }, estimator_);
  next_ = index + 1;
}

KinematicState NetworkObserver::coded(std::int64_t first, const KinematicState& anchor,
                                      std::span<const Vec3> decoded) noexcept {
  KinematicState before = anchor;  // with the commands as they were made
  KinematicState after = anchor;   // as every receiver decodes them
  std::int64_t index = first;
  for (const Vec3& command : decoded) {
    before.acceleration_m_per_s2 = ring_.acceleration(index);
    before = advanced(before, period_s_);
    after.acceleration_m_per_s2 = command;
    ring_.store(index++, after);
    after = advanced(after, period_s_);
  }
  next_ = index;
  const KinematicState change{.position_m = after.position_m - before.position_m,
                              .velocity_m_per_s = after.velocity_m_per_s - before.velocity_m_per_s};
  std::visit([&](auto& estimator) { estimator.replaced(ring_, next_, change); }, estimator_);
  return after;
}

void NetworkObserver::measured(std::span<const SlaveSample> samples) noexcept {
  if (samples.empty()) return;
  std::visit(
      [&](auto& estimator) {
        for (const SlaveSample& sample : samples) estimator.measured(ring_, sample, next_);
        estimator.replaced(ring_, next_, KinematicState{});
      },
      estimator_);
  if (samples.back().applied) delay_s_ = static_cast<double>(next_ - samples.back().index) * period_s_;
}

KinematicState NetworkObserver::prediction(const KinematicState& model) noexcept {
  ring_.store(next_, model);
  return std::visit([&](const auto& estimator) { return estimator.prediction(ring_, next_); }, estimator_);
}

Vec3 NetworkObserver::disturbance_m_per_s2() const noexcept {
  return std::visit([](const auto& estimator) { return estimator.disturbance(); }, estimator_);
}

Vec3 NetworkObserver::innovation_m() const noexcept {
  return std::visit([](const auto& estimator) { return estimator.innovation(); }, estimator_);
}

Vec3 NetworkObserver::take_correction() noexcept {
  return std::visit([](auto& estimator) { return estimator.take_correction(); }, estimator_);
}

}  // namespace telekerf::master
