// SPDX-License-Identifier: Apache-2.0
// What contouring control is held against: independent joints (eq. 21-24, 32), how they are tuned, and what
// "the same bandwidth along the path" means for loops that have an observer beside their gains.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/machining/contour_run.h"

namespace telekerf::experiments {

/// Where the closed loop falls to -3 dB, Hz: from the measured to the true position of one joint under a
/// critically damped law of `law_rad_s` with the observer and the delay of `settings`.
double closed_loop_hz(double law_rad_s, const machining::PathFollowerSettings& settings);

/// The thesis' law at its best at 8 mm/s among the loops that are as fast along the path as contouring
/// control's is there (84 Hz): least product of the errors on cam, gear and octagon over 40-170, 60-1000 and
/// 400-3600 rad/s.
ContourRunSettings tuned_independent(ContourRunSettings settings);

/// More than the thesis' law, and twice as fast a loop: friction at the reference velocity, the weight at the
/// start and preview for every joint, and the observer that then leaves the least product of the errors.
ContourRunSettings assisted_independent(const ContourRunSettings& settings);

/// Names and figures of a run's tuning.
nlohmann::ordered_json tuning(const ContourRunSettings& settings);

/// The settings in use beside independent joints of every kind; entries as in docs/results/machining.md.
nlohmann::ordered_json equal_terms(const machining::TimedPath& plan, const geometry::Polyline& contour,
                                   const ContourRunSettings& used);

/// Of the errors across the path, rms, in two results of measure().
double normal_error_ratio(const nlohmann::ordered_json& ours, const nlohmann::ordered_json& theirs);

}  // namespace telekerf::experiments
