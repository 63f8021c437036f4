// SPDX-License-Identifier: Apache-2.0
#include "master/observer/estimators.h"

#include <fmt/format.h>

#include "common/runtime/startup_error.h"

namespace telekerf::master {

MakeEstimator estimator_named(const std::string& name) {
  if (const auto make = kEstimators.find(name)) return *make;
  std::string words;
  for (const auto& row : kEstimators) words += (words.empty() ? "" : ", ") + std::string(row.word);
  throw configuration_error(fmt::format("estimator = '{}' must be one of {}", name, words));
}

}  // namespace telekerf::master
