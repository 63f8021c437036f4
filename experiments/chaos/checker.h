// SPDX-License-Identifier: Apache-2.0
// Beside the plant, not in the slave: what was really burnt and moved, held against what may be. It knows the
// true time and place, and when each command was made.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/control/kinematic_state.h"
#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "common/robot/robot_model.h"
#include "common/runtime/enum_table.h"

namespace telekerf::experiments {

/// What a run is judged by.
enum class Bar : std::uint8_t {
  kOutside,
  kDose,
  kPermit,
  kRelight,
  kBeamAge,
  kLaserOff,
  kJump,
  kLimit,
  kRecovery,
};
inline constexpr EnumRow<Bar> kBarRows[] = {
    {"outside", Bar::kOutside, "energy outside the corridor"},
    {"dose", Bar::kDose, "energy within 0.1 mm"},
    {"permit", Bar::kPermit, "light later than two ticks after the interlock's last yes"},
    {"relight", Bar::kRelight, "light again without a new engage or without the button released"},
    {"beam-age", Bar::kBeamAge, "light on a command older than the gate and a tick"},
    {"laser-off", Bar::kLaserOff, "light longer than a tick after a stop or another contour"},
    {"jump", Bar::kJump, "the reference or the tool jumps"},
    {"limit", Bar::kLimit, "speed, acceleration or workspace exceeded"},
    {"recovery", Bar::kRecovery, "no cut after everything was healed and engaged once"},
};
inline constexpr EnumTable<Bar> kBars(kBarRows);
inline constexpr std::size_t kBarCount = std::size(kBarRows);

/// When the commands of every sender were made, true time.
class BirthRegister {
 public:
  /// The youngest of several counts.
  void made(std::uint32_t epoch, Tick tick, std::int64_t true_ns);
  std::optional<std::int64_t> of(std::uint32_t epoch, Tick tick) const;

 private:
  std::unordered_map<std::uint32_t, std::vector<std::int64_t>> born_ns_;
};

/// One slave step, as it was in truth.
struct Observation {
  std::int64_t now_ns = 0;  ///< true time
  double period_s = 1e-3;   ///< until the next step
  Vec3 tool_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  control::KinematicState reference = {};
  double told_w = 0.0;               ///< what the laser was told
  double emitted_w = 0.0;            ///< what it gave
  bool permitted = false;            ///< the interlock said yes in this step
  bool stuck = false;                ///< the laser gives what it likes: booked apart
  std::optional<double> age_s = {};  ///< of the command in force
};

struct Findings {
  double energy_inside_j = 0.0;
  double energy_outside_j = 0.0;
  double energy_stuck_j = 0.0;  ///< by a laser that is stuck: nobody could have put it out
  double energy_unpermitted_j = 0.0;
  double dose_j = 0.0;  ///< largest within 0.1 mm
  int limit_violations = 0;
  int jumps = 0;
  int relights = 0;
  int laser_off_ticks = 0;
  double beam_age_s = 0.0;
  std::array<std::optional<double>, kBarCount> first_s;  ///< when each bar was missed first

  bool missed(Bar bar) const noexcept { return first_s[static_cast<std::size_t>(bar)].has_value(); }
  bool failed() const noexcept;
};

struct CheckerSettings {
  double corridor_m = 0.5e-3;
  double gate_s = 0.35;  ///< oldest command that the beam may be on for
  double dose_j = 1e9;   ///< most within 0.1 mm
  double tick_s = 1e-3;
};

class Checker {
 public:
  /// `model`: limits and workspace of the slave's robot.
  Checker(const robot::RobotModel& model, const CheckerSettings& settings);

  /// The contour that the beam may be on from now on; outlives its use. Null: none.
  void contour(const geometry::NearestIndex* contour) noexcept { contour_ = contour; }
  /// Whatever asks for a deliberate restart: stop, clear, another contour, outage, a process begins. Told
  /// when the slave learns of it; `at_ns` is when it happened, so that what is still under way counts as
  /// heard.
  void needs_restart(std::int64_t at_ns) noexcept;
  /// The operator engages.
  void engaged(std::int64_t at_ns) noexcept;
  /// The operator's button, every step of the master.
  void button(std::int64_t at_ns, bool pressed) noexcept;
  /// A true master's block has reached the slave; its newest sample was made at `born_ns`.
  void heard(std::int64_t at_ns, std::int64_t born_ns) noexcept;
  /// The beam is to be off from here: the slave has been told to stop, or of another contour.
  void off_is_due() noexcept { off_due_ = true; }
  /// The slave was not there: no step between the last and the next.
  void interrupted() noexcept { last_.reset(); }

  void observe(const Observation& now);
  /// Light at standstill, while nobody steps: what a laser gives until its own silence rule.
  void afterglow(const Observation& now, double seconds);
  void not_recovered(std::int64_t at_ns) noexcept { miss(Bar::kRecovery, at_ns); }
  const Findings& findings() const noexcept { return findings_; }

 private:
  void miss(Bar bar, std::int64_t at_ns) noexcept;
  void judge_beam(const Observation& now);
  void judge_motion(const Observation& now);
  void book(const Observation& now, double seconds);
  void deposit(const Vec2& at_m, double energy_j, std::int64_t now_ns);

  robot::RobotModel model_;
  CheckerSettings settings_;
  Findings findings_;
  const geometry::NearestIndex* contour_ = nullptr;
  std::int64_t restart_needed_ns_ = 0;
  std::int64_t engaged_ns_ = -1;
  std::int64_t released_ns_ = -1;
  std::int64_t heard_ns_ = -1;
  std::int64_t heard_born_ns_ = -1;
  std::int64_t permitted_ns_ = -1;
  std::optional<std::int64_t> relit_for_;  ///< the cause that a relight was counted for
  bool off_due_ = false;
  int off_ticks_ = 0;
  bool beyond_limits_ = false;
  std::optional<Observation> last_;
  Vec3 last_step_m_ = Vec3::Zero();
  bool has_step_ = false;
  std::vector<float> dose_j_;
};

}  // namespace telekerf::experiments
