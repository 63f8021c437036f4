// SPDX-License-Identifier: Apache-2.0
// A run as a page plays it: both robots, the hand and the beam at each of the master's ticks, in a form that a
// browser reads without a library. docs/reference/recording.md, "Played in the console".
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "common/recording/run_record.h"

namespace telekerf::reporting {

/// One moment, in this order. SI; places in the workpiece frame, the master's scaled into it by beta. NaN: not
/// known then. The slave's are of the same moment by the comparison of both clocks.
inline constexpr std::array<std::string_view, 24> kPlaybackFields{
    "t_s",              // since the run began
    "engaged",          // 1: the slave follows
    "button",           // 1: the laser is wanted
    "beta",             //
    "tool_x_m",         // the master's
    "tool_y_m",         //
    "speed_m_per_s",    //
    "hand_x_n",         // force of the hand on the master's tool
    "hand_y_n",         //
    "constraint_n",     // by which the constraint answers
    "off_line_m",       // the master's tool, to the left of the drawing direction
    "slave_x_m",        // the slave's tool
    "slave_y_m",        //
    "slave_z_m",        //
    "slave_speed_m_per_s",  //
    "laser_w",          //
    "interlock",        // the contract's number
    "applied_tick",     // the master's, that the slave applies; -1: none
    "behind_s",         // how long ago that tick was
    "tracking_m",       // the slave's tool and the master's of that tick apart
    "predicted_x_m",    // where the master expected the slave at its own tick
    "predicted_y_m",    //
    "prediction_m",     // that, for the applied tick, and the slave's tool apart
    "slave_force_n"};   // of the world on the slave's tool, as estimated there

struct PlaybackHead {
  std::string name;     ///< of the run
  std::string created;  ///< ISO 8601
  std::string state;    ///< "closed", "recovered", "recording"
};

/// Rows beyond this are thinned out evenly; the head says by how much.
inline constexpr std::size_t kMostPlaybackRows = 600'000;

/// Length of the head (uint32), a head of JSON padded with spaces to a multiple of four, and rows of float32
/// in the order of kPlaybackFields; little endian. The head: name, created, state, fields, rows, every (ticks a
/// row), step_s, contours (from_row, closed, points x, y, ..., in m), words. Same record, same bytes.
std::string playback_of(const RunRecord& record, const PlaybackHead& head);

}  // namespace telekerf::reporting
