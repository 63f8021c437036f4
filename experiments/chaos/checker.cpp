// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/checker.h"

#include <algorithm>
#include <cmath>

namespace telekerf::experiments {
namespace {

/// Beyond what the slave itself must notice: steps of either side, and a reading's noise.
constexpr double kSilenceMargin_s = 0.05;
constexpr double kNoise_m_per_s = 1e-3;
constexpr double kLimitMargin = 1.1;
constexpr double kWorkspaceMargin_m = 0.2e-3;
/// Raster of the dose, and what of it lies within 0.1 mm of a cell.
constexpr double kCell_m = 0.05e-3;
constexpr int kCells = 1200;  ///< a side: 60 mm
constexpr int kReach = 2;
constexpr std::size_t kMostTicks = 1U << 20U;

}  // namespace

void BirthRegister::made(std::uint32_t epoch, Tick tick, std::int64_t true_ns) {
  if (tick >= kMostTicks) return;
  std::vector<std::int64_t>& born = born_ns_[epoch];
  if (born.size() <= tick) born.resize(std::max<std::size_t>(tick + 1, 2 * born.size()), -1);
  born[tick] = std::max(born[tick], true_ns);
}

std::optional<std::int64_t> BirthRegister::of(std::uint32_t epoch, Tick tick) const {
  const auto found = born_ns_.find(epoch);
  if (found == born_ns_.end() || tick >= found->second.size() || found->second[tick] < 0) return {};
  return found->second[tick];
}

bool Findings::failed() const noexcept {
  return std::any_of(first_s.begin(), first_s.end(), [](const auto& at) { return at.has_value(); });
}

Checker::Checker(const robot::RobotModel& model, const CheckerSettings& settings)
    : model_(model), settings_(settings), dose_j_(std::size_t{kCells} * kCells, 0.0F) {}

void Checker::miss(Bar bar, std::int64_t at_ns) noexcept {
  auto& first = findings_.first_s[static_cast<std::size_t>(bar)];
  if (!first) first = static_cast<double>(at_ns) * 1e-9;
}

void Checker::needs_restart(std::int64_t at_ns) noexcept {
  restart_needed_ns_ = std::max(restart_needed_ns_, at_ns);
}

void Checker::engaged(std::int64_t at_ns) noexcept { engaged_ns_ = at_ns; }

void Checker::button(std::int64_t at_ns, bool pressed) noexcept {
  if (!pressed) released_ns_ = at_ns;
}

void Checker::heard(std::int64_t at_ns, std::int64_t born_ns) noexcept {
  // An outage: whatever comes after it needs a deliberate restart since the last block before it was made.
  if (heard_ns_ >= 0 && static_cast<double>(at_ns - heard_ns_) * 1e-9 > settings_.gate_s + kSilenceMargin_s)
    needs_restart(heard_born_ns_);
  heard_ns_ = at_ns;
  heard_born_ns_ = std::max(heard_born_ns_, born_ns);
}

void Checker::observe(const Observation& now) {
  judge_beam(now);
  judge_motion(now);
  book(now, now.period_s);
}

void Checker::afterglow(const Observation& now, double seconds) { book(now, seconds); }

void Checker::judge_beam(const Observation& now) {
  if (now.permitted) permitted_ns_ = now.now_ns;
  if (now.told_w <= 0.0) {
    off_due_ = false;
    off_ticks_ = 0;
    return;
  }
  if (off_due_) {
    findings_.laser_off_ticks = std::max(findings_.laser_off_ticks, ++off_ticks_);
    if (off_ticks_ > 1) miss(Bar::kLaserOff, now.now_ns);
  }
  if (now.age_s) {
    findings_.beam_age_s = std::max(findings_.beam_age_s, *now.age_s);
    if (*now.age_s > settings_.gate_s + settings_.tick_s) miss(Bar::kBeamAge, now.now_ns);
  }
  // Off and on again since the cause; what is still on has not been put out yet, and is no relight.
  const bool lit_anew = !last_ || last_->told_w <= 0.0;
  const bool deliberate = engaged_ns_ > restart_needed_ns_ && released_ns_ > restart_needed_ns_;
  if (lit_anew && !deliberate && relit_for_ != restart_needed_ns_) {
    relit_for_ = restart_needed_ns_;
    ++findings_.relights;
    miss(Bar::kRelight, now.now_ns);
  }
}

void Checker::judge_motion(const Observation& now) {
  const double dt = now.period_s;
  const auto& limits = model_.limits;
  bool beyond = now.velocity_m_per_s.norm() > kLimitMargin * limits.velocity_m_per_s ||
                now.tool_m.head<2>().norm() > model_.workspace.radius_m + kWorkspaceMargin_m ||
                std::abs(now.tool_m.z()) > 0.5 * model_.workspace.height_m + kWorkspaceMargin_m ||
                !now.tool_m.allFinite();
  if (last_) {
    const double allowed = kLimitMargin * limits.acceleration_m_per_s2 * dt + kNoise_m_per_s;
    const Vec3 step_m = now.tool_m - last_->tool_m;
    beyond = beyond || (now.velocity_m_per_s - last_->velocity_m_per_s).norm() > allowed;
    const auto& was = last_->reference;
    const Vec3 gap_m = now.reference.position_m - was.position_m -
                       0.5 * dt * (was.velocity_m_per_s + now.reference.velocity_m_per_s);
    const bool jumped = (now.reference.velocity_m_per_s - was.velocity_m_per_s).norm() > allowed ||
                        gap_m.norm() > 0.5 * dt * allowed ||
                        (has_step_ && (step_m - last_step_m_).norm() / dt > 2.0 * allowed);
    if (jumped) {
      ++findings_.jumps;
      miss(Bar::kJump, now.now_ns);
    }
    last_step_m_ = step_m;
  }
  has_step_ = last_.has_value();
  if (beyond && !beyond_limits_) {
    ++findings_.limit_violations;
    miss(Bar::kLimit, now.now_ns);
  }
  beyond_limits_ = beyond;
  last_ = now;
}

void Checker::book(const Observation& now, double seconds) {
  if (now.emitted_w <= 0.0) return;
  // What a laser that fails gives beyond what it was told is booked apart.
  const double own_w = now.stuck ? std::max(0.0, now.emitted_w - now.told_w) : 0.0;
  findings_.energy_stuck_j += own_w * seconds;
  const double energy_j = (now.emitted_w - own_w) * seconds;
  if (energy_j <= 0.0) return;
  if (permitted_ns_ < 0 || static_cast<double>(now.now_ns - permitted_ns_) * 1e-9 > 2.01 * settings_.tick_s) {
    findings_.energy_unpermitted_j += energy_j;
    miss(Bar::kPermit, now.now_ns);
  }
  const Vec2 at_m = now.tool_m.head<2>();
  if (contour_ != nullptr && contour_->find(at_m).distance_m <= settings_.corridor_m) {
    findings_.energy_inside_j += energy_j;
  } else {
    findings_.energy_outside_j += energy_j;
    miss(Bar::kOutside, now.now_ns);
  }
  deposit(at_m, energy_j, now.now_ns);
}

void Checker::deposit(const Vec2& at_m, double energy_j, std::int64_t now_ns) {
  const auto cell = [](double m) {
    return std::clamp(static_cast<int>(std::floor(m / kCell_m)) + kCells / 2, kReach, kCells - 1 - kReach);
  };
  const int column = cell(at_m.x());
  const int row = cell(at_m.y());
  const auto place = [](int r, int c) {
    return static_cast<std::size_t>(r) * kCells + static_cast<std::size_t>(c);
  };
  // Each cell knows what fell within 0.1 mm of it.
  for (int r = -kReach; r <= kReach; ++r) {
    for (int c = -kReach; c <= kReach; ++c) {
      if (r * r + c * c > kReach * kReach) continue;
      float& around = dose_j_[place(row + r, column + c)];
      around += static_cast<float>(energy_j);
      findings_.dose_j = std::max(findings_.dose_j, static_cast<double>(around));
    }
  }
  if (findings_.dose_j > settings_.dose_j) miss(Bar::kDose, now_ns);
}

}  // namespace telekerf::experiments
