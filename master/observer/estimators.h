// SPDX-License-Identifier: Apache-2.0
// The estimators by their names: a new one is a file, a line in each of the two lists here, and a test.
#pragma once

#include <string>
#include <variant>

#include "common/protocol/messages.h"
#include "common/runtime/enum_table.h"
#include "master/observer/command_window.h"
#include "master/observer/communication_disturbance_observer.h"
#include "master/observer/delayed_innovation.h"
#include "master/observer/estimator.h"
#include "master/observer/no_prediction.h"
#include "master/observer/open_integrator.h"
#include "master/observer/propagated_predictor.h"
#include "master/observer/reference_model_estimator.h"

namespace telekerf::master {

using AnyEstimator =
    std::variant<NoPrediction, CommunicationDisturbanceObserver, CommandWindow,
                 DelayedInnovation<OpenIntegrator>, DelayedInnovation<CommunicationDisturbanceObserver>,
                 PropagatedPredictor, ReferenceModelEstimator>;
using MakeEstimator = AnyEstimator (*)(Law law, const EstimatorSettings& settings);

template <Estimator E>
AnyEstimator make_estimator(Law /*law*/, const EstimatorSettings& settings) {
  return E(settings);
}
/// A slave that follows a reference is no open integrator: it is where the reference is.
inline AnyEstimator make_predictor(Law law, const EstimatorSettings& settings) {
  if (law == Law::kRemoteAcceleration) return PropagatedPredictor(settings);
  return ReferenceModelEstimator(settings);
}

inline constexpr EnumRow<MakeEstimator> kEstimatorRows[] = {
    {"predictor", &make_predictor, "its own commands replayed from what the slave acknowledged last"},
    {"delayed-innovation", &make_estimator<DelayedInnovation<OpenIntegrator>>,
     "a model that old measurements correct"},
    {"thesis", &make_estimator<CommunicationDisturbanceObserver>,
     "the thesis' communication disturbance observer"},
    {"thesis-convergent", &make_estimator<DelayedInnovation<CommunicationDisturbanceObserver>>,
     "the same, corrected by old measurements"},
    {"thesis-window", &make_estimator<CommandWindow>,
     "the newest measurement, and eq. 94's integral of the commands since"},
    {"none", &make_estimator<NoPrediction>, "the newest measurement is taken for the present"}};
/// The words of command lines and reports.
inline constexpr EnumTable<MakeEstimator> kEstimators(kEstimatorRows);

/// Throws StartupError.
MakeEstimator estimator_named(const std::string& name);

}  // namespace telekerf::master
