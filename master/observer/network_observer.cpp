// SPDX-License-Identifier: Apache-2.0
#include "master/observer/network_observer.h"

#include <variant>

namespace telekerf::master {

NetworkObserver::NetworkObserver(Law law, const ObserverSettings& settings)
    : period_s_(settings.period_s), estimator_(settings.estimator(law, settings)) {}

void NetworkObserver::reset(std::int64_t index, const KinematicState& state) noexcept {
  next_ = index;
  std::visit([&](auto& estimator) { estimator.reset(index, state); }, estimator_);
}

void NetworkObserver::predict(std::int64_t index, const KinematicState& model, const Vec3& command) noexcept {
  KinematicState commanded = model;
  commanded.acceleration_m_per_s2 = command;
  history_.store(index, commanded);
  std::visit([&](auto& estimator) { estimator.predict(history_, index); }, estimator_);
  next_ = index + 1;
}

void NetworkObserver::revise_estimator(const KinematicState& change) noexcept {
  std::visit(
      [&]<class E>(E& estimator) {
        if constexpr (RevisesCommands<E>) estimator.revise(history_, next_, change);
      },
      estimator_);
}

KinematicState NetworkObserver::revise(std::int64_t first, const KinematicState& anchor,
                                       std::span<const Vec3> decoded) noexcept {
  KinematicState before = anchor;  // with the commands as they were made
  KinematicState after = anchor;   // as every receiver decodes them
  std::int64_t index = first;
  for (const Vec3& command : decoded) {
    before.acceleration_m_per_s2 = history_.acceleration(index);
    before = advanced(before, period_s_);
    after.acceleration_m_per_s2 = command;
    history_.store(index++, after);
    after = advanced(after, period_s_);
  }
  next_ = index;
  revise_estimator({.position_m = after.position_m - before.position_m,
                    .velocity_m_per_s = after.velocity_m_per_s - before.velocity_m_per_s});
  return after;
}

void NetworkObserver::correct(std::span<const SlaveSample> samples) noexcept {
  if (samples.empty()) return;
  std::visit(
      [&](auto& estimator) {
        for (const SlaveSample& sample : samples) estimator.correct(history_, sample, next_);
      },
      estimator_);
  revise_estimator({});
  if (samples.back().applied) delay_s_ = static_cast<double>(next_ - samples.back().index) * period_s_;
}

KinematicState NetworkObserver::predicted_state(const KinematicState& model) noexcept {
  history_.store(next_, model);
  return std::visit([&](const auto& estimator) { return estimator.predicted_state(history_, next_); },
                    estimator_);
}

Vec3 NetworkObserver::disturbance_m_per_s2() const noexcept {
  return std::visit(
      []<class E>(const E& estimator) -> Vec3 {
        if constexpr (EstimatesDisturbance<E>) return estimator.disturbance_m_per_s2();
        return Vec3::Zero();
      },
      estimator_);
}

Vec3 NetworkObserver::innovation_m() const noexcept {
  return std::visit(
      []<class E>(const E& estimator) -> Vec3 {
        if constexpr (HasInnovation<E>) return estimator.innovation_m();
        return Vec3::Zero();
      },
      estimator_);
}

Vec3 NetworkObserver::take_correction_m() noexcept {
  return std::visit(
      []<class E>(E& estimator) -> Vec3 {
        if constexpr (CorrectsModel<E>) return estimator.take_correction_m();
        return Vec3::Zero();
      },
      estimator_);
}

}  // namespace telekerf::master
