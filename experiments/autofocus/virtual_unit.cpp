// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/virtual_unit.h"

#include <cmath>
#include <utility>

namespace telekerf::experiments {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kLongestMove_s = 20.0;
/// A goal that differs less than this is the same.
constexpr double kSameGoal_m = 1e-7;

}  // namespace

using namespace imaging;

VirtualUnit::VirtualUnit(const VirtualUnitSettings& settings, Object object)
    : settings_(settings),
      axes_(settings.axes, {1e-3, 1e-3}, settings.mismatch, settings.seed),
      control_(settings.axes, {.period_s = kPeriod_s}),
      microscope_(settings.microscope, std::move(object)) {
  while (control_.state() == AxesControl::State::kHoming && time_s_ < kLongestMove_s) step();
  control_.approach(kMagnification, settings.magnification_m);
  control_.approach(kFocus, settings.focus_m);
  settle();
  time_s_ = 0.0;
  steps_ = 0;
}

void VirtualUnit::step() {
  axes_.write(control_.step(axes_.read()));
  axes_.advance(kPeriod_s);
  time_s_ = static_cast<double>(++steps_) * kPeriod_s;
}

void VirtualUnit::run(double seconds) {
  const auto until = steps_ + std::llround(seconds / kPeriod_s);
  while (steps_ < until) step();
}

bool VirtualUnit::settle() {
  const double until_s = time_s_ + kLongestMove_s;
  do {
    step();
  } while (!control_.settled() && time_s_ < until_s);
  return control_.settled();
}

cv::Mat VirtualUnit::next_frame() {
  const double next_s =
      (std::floor(time_s_ / settings_.frame_period_s + 1e-6) + 1.0) * settings_.frame_period_s;
  run(next_s - time_s_);
  if (before_picture) before_picture(time_s_, microscope_.object());
  ++pictures_;
  return microscope_.picture(axes_.optics_m(), time_s_);
}

cv::Mat VirtualUnit::look(double position_m) {
  control_.approach(kFocus, position_m);
  settle();
  return next_frame();
}

FocusRange VirtualUnit::range(double depth_of_field_m) const noexcept {
  return {.start_m = control_.position_m(kFocus),
          .lowest_m = control_.lowest_m(),
          .highest_m = control_.highest_m(kFocus),
          .depth_of_field_m = depth_of_field_m};
}

FocusResult run_search(VirtualUnit& unit, FocusSearch search) {
  while (const auto next_m = search.next_m()) {
    const cv::Mat region = unit.look(*next_m);
    search.seen(region, unit.measured_m().focus_m);
  }
  if (search.result().found()) {
    unit.control().approach(kFocus, search.result().position_m);
    unit.settle();
  }
  return search.result();
}

void focus_now(VirtualUnit& unit, Autofocus& autofocus) {
  double goal_m = autofocus.goal_m(unit.measured_m(), false);
  while (autofocus.state() == Autofocus::State::kSearching) {
    const cv::Mat region = unit.look(goal_m);
    autofocus.seen(region, unit.measured_m());
    goal_m = autofocus.goal_m(unit.measured_m(), false);
  }
  unit.control().approach(kFocus, goal_m);
  unit.settle();
}

bool LiveFocus::step(const cv::Mat& picture, bool zooming) {
  const bool counts = arrived_ && !zooming;
  if (counts) autofocus_.seen(picture, unit_.measured_m());
  const double goal_m = autofocus_.goal_m(unit_.measured_m(), zooming);
  if (std::abs(goal_m - unit_.control().goal_m(kFocus)) > kSameGoal_m) unit_.control().approach(kFocus, goal_m);
  arrived_ = unit_.control().settled();
  return counts && autofocus_.sharp();
}

}  // namespace telekerf::experiments
