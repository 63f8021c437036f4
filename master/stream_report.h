// SPDX-License-Identifier: Apache-2.0
// What a report says of the command stream and its link.
#pragma once

#include "common/recording/run_record.h"
#include "master/master_node.h"
#include "master/station_settings.h"

namespace telekerf::master {

/// The master's figures and words: scale, seed, codec, bytes, round trips, clocks. `settings`: those in
/// force.
void report_stream(const StationSettings& settings, const MasterNode& node, RunRecord& record);

}  // namespace telekerf::master
