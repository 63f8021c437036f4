// SPDX-License-Identifier: Apache-2.0
// The tables of docs/results/machining.md, out of the results of closed-contour and machine.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/reporting/page_tables.h"

namespace telekerf::experiments {

/// `contours`: what each picture of the set came to. `terms`: normal error, rms in um, of contouring and of
/// independent joints, and their ratio, a column a picture.
std::vector<reporting::PageTable> contour_tables(const nlohmann::ordered_json& pictures);

/// `machine`: what the whole work of each picture came to.
reporting::PageTable machine_table(const nlohmann::ordered_json& works);

}  // namespace telekerf::experiments
