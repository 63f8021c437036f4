// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_story.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/reporting/picture_file.h"
#include "common/reporting/plot.h"
#include "experiments/autofocus/virtual_unit.h"
#include "slave/vision/imaging/autofocus.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::experiments {
namespace {

using namespace imaging;
using reporting::Line;
using reporting::Panel;

constexpr double kZoomFrom_s = 1.0;
constexpr double kZoomTime_s = 2.0;
constexpr double kDuration_s = 10.0;
constexpr int kStrip = 8;

/// The magnification axis follows a smooth reference that a computer made.
double magnification_at(double time_s, double from_m, double to_m) {
  const double s = std::clamp((time_s - kZoomFrom_s) / kZoomTime_s, 0.0, 1.0);
  return from_m + (to_m - from_m) * s * s * (3.0 - 2.0 * s);
}

/// The ridge has been learnt at four magnifications, on this very object.
Autofocus taught(std::uint64_t seed) {
  VirtualUnit unit = story_unit(seed, 0.01, 3.0);
  Autofocus autofocus({}, unit.microscope().settings().model, unit.control().lowest_m(),
                      unit.control().highest_m(kFocus));
  for (const double magnification_m : {0.01, 0.03, 0.05, 0.07}) {
    unit.control().move_to(kMagnification, magnification_m);
    unit.settle();
    focus_now(unit, autofocus);
  }
  return autofocus;
}

void add_frame(StoryRun& run, VirtualUnit& unit, const cv::Mat& picture) {
  run.frames.push_back({unit.time_s(), unit.measured_m().magnification_m,
                        normalised_variance(grey_sums(picture)), unit.defocus_dof(), false});
  const double next_s = static_cast<double>(run.strip.size()) * kDuration_s / kStrip;
  if (unit.time_s() < next_s) return;
  run.strip.push_back(picture);
  run.strip_time_s.push_back(unit.time_s());
}

}  // namespace

VirtualUnit story_unit(std::uint64_t seed, double magnification_m, double defocus_dof) {
  VirtualUnitSettings settings;
  settings.seed = settings.microscope.seed = seed;
  settings.magnification_m = magnification_m;
  const ImagingModel& model = settings.microscope.model;
  settings.focus_m =
      model.best_focus_m(magnification_m) + defocus_dof * model.depth_of_field_m(magnification_m);
  Object object;
  object.metres_per_texel = 1e-5;
  object.texture = draw_target(Target::kRelief, 768, 1.5, seed);
  return {settings, object};
}

StoryRun run_story(FocusStory story, FocusLaw law, std::uint64_t seed) {
  const bool in = story == FocusStory::kZoomIn;
  const double from_m = in ? 0.024 : 0.056;
  const double to_m = in ? 0.048 : 0.028;
  VirtualUnit unit = story_unit(seed, from_m, in ? -5.0 : 0.0);
  const double dof_m = unit.microscope().settings().model.depth_of_field_m(0.5 * (from_m + to_m));
  Autofocus autofocus = taught(seed);
  PrintedFocusLaw printed(
      {.mu_0_m_per_s = dof_m / unit.frame_period_s(), .alpha = dof_m, .window_m = 0.5 * dof_m});
  StoryRun run;
  LiveFocus live(unit, autofocus);
  while (unit.time_s() < kDuration_s) {
    const cv::Mat picture = unit.next_frame();
    add_frame(run, unit, picture);
    unit.control().move_to(kMagnification, magnification_at(unit.time_s(), from_m, to_m));
    const bool zooming = unit.time_s() >= kZoomFrom_s && unit.time_s() < kZoomFrom_s + kZoomTime_s + 0.3;
    if (law == FocusLaw::kThesis) {
      const double velocity = printed.step(unit.measured_m().focus_m, run.frames.back().sharpness);
      // It starts once the magnification is changed (8.5): the motion shakes the focus by a window.
      const double since_s = unit.time_s() - kZoomFrom_s;
      const bool shaken = since_s > 0.0 && since_s < 2.5 * unit.frame_period_s();
      unit.control().drive(kFocus, shaken ? dof_m / unit.frame_period_s() : velocity);
      continue;
    }
    run.frames.back().passed_on = live.step(picture, zooming);
  }
  return run;
}

namespace {

Line line_of(const StoryRun& run, double StoryFrame::*value, double unit, const std::string& label) {
  Line line{.label = label};
  for (const StoryFrame& frame : run.frames) {
    line.x.push_back(frame.time_s);
    line.y.push_back(unit * frame.*value);
  }
  return line;
}

void draw_story(FocusStory story, std::uint64_t seed, const std::string& number,
                const std::filesystem::path& folder) {
  const StoryRun ours = run_story(story, FocusLaw::kSearch, seed);
  const StoryRun printed = run_story(story, FocusLaw::kThesis, seed);
  const auto panel = [&](const char* title, const char* label, double StoryFrame::*value, double unit) {
    return Panel{.title = title,
                 .x_label = "time [s]",
                 .y_label = label,
                 .lines = {line_of(ours, value, unit, "search and track"),
                           line_of(printed, value, unit, "as printed")}};
  };
  reporting::draw_figure(
      {.title = number +
                (story == FocusStory::kZoomIn ? " defocused, then zoomed in" : " in focus, then zoomed out"),
       .panels = {panel("(A) magnification level", "position of the magnification axis [mm]",
                        &StoryFrame::magnification_m, 1e3),
                  panel("(B) sharpness level (eq. 155)", "normalised variance [grey levels]",
                        &StoryFrame::sharpness, 1.0),
                  panel("true defocus", "distance from the focus [depths of field]", &StoryFrame::defocus_dof,
                        1.0)},
       .columns = 3},
      folder / ("figure-" + number + ".png"));
  if (story != FocusStory::kZoomOut) return;
  cv::Mat strip;
  std::vector<cv::Mat> pictures;
  for (std::size_t i = 0; i < ours.strip.size(); ++i) {
    cv::Mat picture;
    cv::cvtColor(ours.strip[i], picture, cv::COLOR_GRAY2BGR);
    cv::putText(picture, fmt::format("{:.1f} s", ours.strip_time_s[i]), {4, 122}, cv::FONT_HERSHEY_SIMPLEX,
                0.4, {0, 255, 255}, 1, cv::LINE_AA);
    pictures.push_back(picture);
  }
  cv::hconcat(pictures, strip);
  const std::filesystem::path pictures_of_it = folder / ("figure-" + number + "-pictures.png");
  reporting::write_picture(pictures_of_it, strip);
  reporting::draw_figure(
      {.panels = {{.title = "(C) what the camera saw: manual defocusing and automatic focusing",
                   .picture = pictures_of_it}},
       .panel_width_px = strip.cols + 40,
       .panel_height_px = strip.rows + 60},
      folder / ("figure-" + number + "-c.png"));
}

}  // namespace

void draw_stories(std::uint64_t seed, const std::filesystem::path& folder) {
  draw_story(FocusStory::kZoomIn, seed, "8.11", folder);
  draw_story(FocusStory::kZoomOut, seed, "8.12", folder);
}

}  // namespace telekerf::experiments
