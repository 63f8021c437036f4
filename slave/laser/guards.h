// SPDX-License-Identifier: Apache-2.0
// What must hold before the beam may be on: named guards, each a value that must be there and lie within its
// limits.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string_view>

#include "common/geometry/corridor.h"
#include "common/protocol/messages.h"

namespace telekerf::laser {

/// Value of a guard that nobody has told: it forbids, as every number does that is not finite.
inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

struct InterlockSettings {
  double corridor_m = geometry::kCorridorHalfWidth_m;
  double reaction_s = 0.003;            ///< the beam may run on this long after the decision
  double measurement_m = 20e-6;         ///< allowance for what the sensors do not see
  double max_tracking_error_m = 50e-6;  ///< tool to where the master wants it, at the tick that is applied
  double max_offset_m = 2e-6;    ///< left of the way back to the master's motion, after an approach or a gap
  double max_height_m = 0.5e-3;  ///< tool above or below the workpiece's surface
  double max_arc_gap_m = 1e-3;   ///< along the contour, between where the tool is and is expected
  double beam_age_s = 0.35;      ///< of the command that is applied
  double max_look_age_s = 0.0;   ///< since the contour was last seen; 0: nobody asks
  double min_cut_speed_m_per_s = 0.0;     ///< a slower tool burns nothing
  double max_dose_j = 2.0;                ///< within 0.1 mm of any place
  double max_area_dose_j_per_mm2 = 20.0;  ///< mean over a square millimetre
  // Of the machine; as long as nobody says them there is no light.
  double workspace_radius_m = -1.0;
  double max_speed_m_per_s = -1.0;
  double max_power_w = -1.0;
};

/// Of one control step. What is not said is not allowed.
struct InterlockInputs {
  bool stopped = true;
  bool fault = true;           ///< one is latched
  bool contour_known = false;  ///< and the same one that the master works on
  bool engaged = false;
  bool armed = false;            ///< engaged by an edge since the last stop, outage, contour, fault and start
  bool button_armed = false;     ///< the button was seen released since then
  bool fresh = false;            ///< the sample being applied really came, and recently
  bool unlit = false;            ///< and is newer than every one that was lit before
  bool on_time = false;          ///< no step came late a short while ago
  bool emission_agrees = false;  ///< the laser gives light only where it was told to
  bool monitor_agrees = false;   ///< the second judgement does not forbid
  double command_age_s = kAbsent;
  double look_age_s = kAbsent;            ///< since the contour in force was last seen where it is
  double radius_m = kAbsent;              ///< tool to the workspace's axis
  double height_m = kAbsent;              ///< magnitude, tool to the workpiece's surface
  double contour_distance_m = kAbsent;    ///< measured tool to the contour, in plane
  double arc_gap_m = kAbsent;             ///< magnitude, see max_arc_gap_m
  double predicted_distance_m = kAbsent;  ///< farthest from the contour that the tool can be in reaction_s
  double speed_m_per_s = kAbsent;         ///< that the tool has or is to have
  double cut_speed_m_per_s = kAbsent;     ///< that the power follows
  double tracking_error_m = kAbsent;
  double offset_m = kAbsent;
  double power_w = kAbsent;  ///< that is wanted if the button decides so
  double dose_j = kAbsent;   ///< what any place within 0.1 mm will have got with it, see DoseBook
  double area_dose_j_per_mm2 = kAbsent;
};

/// Both ends are within.
struct Limits {
  double low = 0.0;
  double high = 0.0;
  bool hold(double value) const noexcept { return std::isfinite(value) && low <= value && value <= high; }
};

struct Guard {
  std::string_view name;
  Interlock reason;
  double (*value)(const InterlockInputs&, const InterlockSettings&) noexcept;
  Limits (*limits)(const InterlockSettings&) noexcept;
  std::string_view sentence;  ///< why it forbids, for people
};

namespace guards {

constexpr Limits yes(const InterlockSettings&) noexcept { return {1.0, 1.0}; }
constexpr double is(bool good) noexcept { return good ? 1.0 : 0.0; }
/// Of parts that are magnitudes each; absent if one of them is not.
constexpr double sum(double a, double b) noexcept { return a >= 0.0 && b >= 0.0 ? a + b : kAbsent; }
using In = const InterlockInputs&;
using Set = const InterlockSettings&;

}  // namespace guards

/// Bit n of a judgement is row n. The first row that forbids is the reason that is reported.
inline constexpr Guard kGuards[] = {
    {"stop", Interlock::kStopped,
     [](guards::In now, guards::Set) noexcept { return guards::is(!now.stopped); }, guards::yes,
     "the emergency stop is latched"},
    {"fault", Interlock::kFault, [](guards::In now, guards::Set) noexcept { return guards::is(!now.fault); },
     guards::yes, "a fault is latched"},
    {"contour", Interlock::kNoContour,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.contour_known); }, guards::yes,
     "no contour is known, or not the one that the master works on"},
    {"engaged", Interlock::kNotEngaged,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.engaged); }, guards::yes,
     "the slave does not follow"},
    {"armed", Interlock::kNotArmed,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.armed); }, guards::yes,
     "nobody has engaged anew since the last stop, outage or start"},
    {"button", Interlock::kNotArmed,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.button_armed); }, guards::yes,
     "the button has not been let go since the last stop, outage or start"},
    {"sample", Interlock::kStale, [](guards::In now, guards::Set) noexcept { return guards::is(now.fresh); },
     guards::yes, "the command that is due or a reading of the joints has not come"},
    {"unlit", Interlock::kStale, [](guards::In now, guards::Set) noexcept { return guards::is(now.unlit); },
     guards::yes, "the command that is applied was lit once already"},
    {"age", Interlock::kAge, [](guards::In now, guards::Set) noexcept { return now.command_age_s; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.beam_age_s};
     },
     "the commands that arrive are older, there and back, than --beam-age-s allows"},
    {"workspace", Interlock::kOutsideWorkspace,
     [](guards::In now, guards::Set) noexcept { return now.radius_m; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.workspace_radius_m};
     },
     "the tool is outside its workspace"},
    {"height", Interlock::kHeight, [](guards::In now, guards::Set) noexcept { return now.height_m; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_height_m};
     },
     "the tool is too far above or below the workpiece"},
    {"corridor", Interlock::kOutsideCorridor,
     [](guards::In now, guards::Set s) noexcept {
       return guards::sum(now.contour_distance_m,
                          guards::sum(now.speed_m_per_s, 0.0) * s.reaction_s + s.measurement_m);
     },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.corridor_m};
     },
     "the tool is outside the corridor about the contour, or about to leave it"},
    {"arc", Interlock::kArc, [](guards::In now, guards::Set) noexcept { return now.arc_gap_m; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_arc_gap_m};
     },
     "the tool is beside another part of the contour than expected"},
    {"predicted", Interlock::kPredicted,
     [](guards::In now, guards::Set s) noexcept {
       return guards::sum(now.predicted_distance_m, s.measurement_m);
     },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.corridor_m};
     },
     "the tool could leave the corridor within the reaction time"},
    {"offset", Interlock::kTracking, [](guards::In now, guards::Set) noexcept { return now.offset_m; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_offset_m};
     },
     "the slave is still on its way to the master's motion"},
    {"tracking", Interlock::kTracking,
     [](guards::In now, guards::Set) noexcept { return now.tracking_error_m; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_tracking_error_m};
     },
     "the tool is too far from where the master wants it"},
    {"speed", Interlock::kSpeed, [](guards::In now, guards::Set) noexcept { return now.speed_m_per_s; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_speed_m_per_s};
     },
     "the tool is faster than the robot's limit"},
    {"moving", Interlock::kSpeed, [](guards::In now, guards::Set) noexcept { return now.cut_speed_m_per_s; },
     [](guards::Set s) noexcept {
       return Limits{s.min_cut_speed_m_per_s, s.max_speed_m_per_s};
     },
     "the tool rests, or is slower than the beam may be on"},
    {"power", Interlock::kPower, [](guards::In now, guards::Set) noexcept { return now.power_w; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_power_w};
     },
     "more power is wanted than the work may have"},
    {"dose", Interlock::kDose, [](guards::In now, guards::Set) noexcept { return now.dose_j; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_dose_j};
     },
     "this place has got all the energy that it may (dose_max_j)"},
    {"area-dose", Interlock::kDose,
     [](guards::In now, guards::Set) noexcept { return now.area_dose_j_per_mm2; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_area_dose_j_per_mm2};
     },
     "the square millimetre about this place has got all the energy that it may (dose_max_j_per_mm2)"},
    {"on-time", Interlock::kLate,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.on_time); }, guards::yes,
     "a control step came late"},
    {"emission", Interlock::kFault,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.emission_agrees); }, guards::yes,
     "the laser gives light that it was not told to give"},
    {"monitor", Interlock::kMonitor,
     [](guards::In now, guards::Set) noexcept { return guards::is(now.monitor_agrees); }, guards::yes,
     "the second judgement forbids the beam"},
    {"look", Interlock::kNoContour,
     [](guards::In now, guards::Set s) noexcept { return s.max_look_age_s > 0.0 ? now.look_age_s : 0.0; },
     [](guards::Set s) noexcept {
       return Limits{0.0, s.max_look_age_s};
     },
     "the contour was not seen where it is for longer than --look-age-s"},
};
inline constexpr std::size_t kGuardCount = std::size(kGuards);
static_assert(kGuardCount <= 31, "a bit each, and one is kRealLaser");

/// Bit of the guard of this name; of a name that is none the program does not compile.
consteval std::uint32_t guard_bit(std::string_view name) {
  for (std::size_t n = 0; n < kGuardCount; ++n) {
    if (kGuards[n].name == name) return std::uint32_t{1} << n;
  }
  throw "no guard has this name";
}

}  // namespace telekerf::laser
