// SPDX-License-Identifier: Apache-2.0
// Whether the manifest names what the experiments leave.
#pragma once

#include <vector>

#include "experiments/report/judgement.h"
#include "experiments/report/manifest.h"
#include "experiments/report/result_store.h"

namespace telekerf::experiments {

/// Throws StartupError, with file, key, value and remedy, for the first key of an experiment that came to its
/// end which names a result, a figure or a place in the result that is not there; what only a full run leaves
/// is not asked of a short one. A place where the run has null is one: nothing was measured.
void require_fit(const Manifest& manifest, const std::vector<Finished>& finished,
                 const ResultsByName& results, bool quick);

}  // namespace telekerf::experiments
