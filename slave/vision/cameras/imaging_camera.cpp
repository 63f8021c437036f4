// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/imaging_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slave/vision/imaging/microscope.h"

namespace telekerf::vision_process {
namespace {

using namespace imaging;

/// A goal that differs less than this is the same.
constexpr double kSameGoal_m = 1e-7;
/// Pictures of the excitation without which the printed law has no gradient.
constexpr int kExcitation = 2;

FocusLawSettings printed_settings(const ImagingCameraSettings& settings) {
  const double dof_m = settings.model.depth_of_field_m(0.5 * settings.model.magnification_travel_m);
  return {.mu_0_m_per_s = dof_m / settings.frame_period_s, .alpha = dof_m, .window_m = 0.5 * dof_m};
}

/// State of the printed law in the telemetry, behind those of the autofocus.
constexpr double kPrintedLaw = 3.0;

std::string in_words(FocusVerdict verdict) {
  for (const auto& row : kFocusVerdicts) {
    if (row.value == verdict) return fmt::format("{}: {}", row.word, row.sentence);
  }
  return {};
}

}  // namespace

cv::Mat focus_grey(const cv::Mat& picture) {
  cv::Mat eight = picture;
  if (picture.depth() == CV_16U) picture.convertTo(eight, CV_8U, 1.0 / 257.0);
  if (eight.channels() == 1) return eight;
  cv::Mat grey;
  cv::cvtColor(eight, grey, eight.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return grey;
}

std::string focus_complaint(const cv::Mat& picture) {
  if (picture.empty())
    return "imaging: the camera shows a file and no picture of its own; it must be a live one, v4l2:N or "
           "video:PATH";
  const int channels = picture.channels();
  if ((picture.depth() != CV_8U && picture.depth() != CV_16U) ||
      (channels != 1 && channels != 3 && channels != 4)) {
    return fmt::format(
        "imaging: the camera's pictures must have 8 or 16 bits and 1, 3 or 4 channels; they have "
        "{} bits and {}",
        8 * picture.elemSize1(), channels);
  }
  if (picture.cols < kTileColumns || picture.rows < kTileRows) {
    return fmt::format("imaging: the camera's pictures must have at least {} x {} pixels; they have {} x {}",
                       kTileColumns, kTileRows, picture.cols, picture.rows);
  }
  return {};
}

ImagingCamera::ImagingCamera(const ImagingCameraSettings& settings, std::shared_ptr<AxesRunner> axes,
                             Source source, Wait wait)
    : settings_(settings),
      axes_(std::move(axes)),
      source_(std::move(source)),
      wait_(std::move(wait)),
      autofocus_({}, settings.model, axes_->lowest_m(), axes_->highest_m(kFocus)),
      printed_(printed_settings(settings)),
      correction_(settings.model) {}

std::string ImagingCamera::refusal() const {
  if (axes_->state() != AxesControl::State::kLost) return {};
  return "the imaging unit's axes do not answer; see that they are on and connected, they home anew once they "
         "answer";
}

bool ImagingCamera::homing() {
  const AxesControl::State state = axes_->state();
  if (state == AxesControl::State::kReady) return false;
  if (std::exchange(homed_, false)) {  // it is as at the start, with the focus that is to be found anew
    autofocus_.refocus();
    focus_goal_m_.reset();
    excited_ = 0;
    still_frames_ = 0;
    lost_ = true;
  }
  if (state == AxesControl::State::kHoming && std::exchange(lost_, false))
    note("the axes answer again after they had stopped; they home anew");
  return true;
}

void ImagingCamera::zoom(double share) {
  settings_.magnification = std::clamp(share, 0.0, 1.0);
  excited_ = 0;
  still_frames_ = 0;
  if (homed_)
    axes_->move_to(kMagnification, settings_.magnification * settings_.model.magnification_travel_m);
}

void ImagingCamera::refocus() {
  excited_ = 0;
  autofocus_.refocus();
}

void ImagingCamera::note(std::string words) {
  if (words == said_) return;
  said_ = words;
  remark_ = std::move(words);
}

std::string ImagingCamera::remark() { return std::exchange(remark_, {}); }

bool ImagingCamera::focus_on(const cv::Mat& grey) {
  const cv::Rect region = central_region(grey.size(), settings_.region);
  const bool zooming = !axes_->settled(kMagnification);
  // A picture counts if both axes stood still at its beginning; they have had no order since.
  const bool counts = still_frames_ > settings_.late_frames && !zooming;
  if (counts) autofocus_.seen(grey(region), axes_->positions_m());
  const double goal_m = autofocus_.goal_m(axes_->positions_m(), zooming);
  if (!focus_goal_m_ || std::abs(goal_m - *focus_goal_m_) > kSameGoal_m) {
    focus_goal_m_ = goal_m;
    axes_->approach(kFocus, goal_m);
    still_frames_ = 0;
  }
  say_state();
  const bool sharp = counts && autofocus_.sharp();
  still_frames_ = axes_->settled() ? still_frames_ + 1 : 0;
  return sharp;
}

void ImagingCamera::adopt(const cv::Size& size) {
  if (size == size_) return;
  size_ = size;
  autofocus_.set_flat(flat_within(settings_.model, size, central_region(size, settings_.region)));
  autofocus_.refocus();
}

bool ImagingCamera::axes_are_held() {
  if (axes_->settled()) arrived_s_ = axes_->time_s();
  return axes_->time_s() - arrived_s_ > axes_->longest_way_s();
}

void ImagingCamera::say_state() {
  if (axes_are_held())
    return note(
        "the axes do not arrive where they are sent; see what holds them, or whether the imaging file is of "
        "this "
        "unit");
  switch (autofocus_.state()) {
    case Autofocus::State::kSearching:
      break;
    case Autofocus::State::kTracking:
      note("in focus");
      break;
    case Autofocus::State::kUnfocused:
      note("no focus found: " + in_words(autofocus_.result().verdict));
      break;
  }
}

void ImagingCamera::stand_still() {
  if (settings_.law != FocusLaw::kThesis || !homed_) return;
  axes_->drive(kFocus, 0.0);
}

bool ImagingCamera::drive_by_printed_law(const cv::Mat& grey) {
  const cv::Mat region = grey(central_region(grey.size(), settings_.region));
  printed_sharpness_ = sharpness_of(region, {});
  note("the printed law moves the focus, and cannot say whether it has arrived");
  const double velocity = printed_.step(axes_->positions_m().focus_m, normalised_variance(grey_sums(region)));
  const bool exciting = excited_ < kExcitation;
  if (exciting) ++excited_;
  axes_->drive(kFocus, exciting ? printed_settings(settings_).mu_0_m_per_s : velocity);
  focus_goal_m_.reset();
  // It cannot say that it has arrived; it does not move much where it has.
  const double dof_m = settings_.model.depth_of_field_m(axes_->positions_m().magnification_m);
  return axes_->settled(kMagnification) && !exciting &&
         std::abs(velocity) * settings_.frame_period_s < 0.1 * dof_m;
}

Camera::Result ImagingCamera::next() {
  wait_();
  const bool homing = this->homing();
  if (const std::string lost = refusal(); !lost.empty()) return tl::unexpected(lost);
  Result result = source_(axes_->optics_m(), axes_->time_s());
  if (!result) stand_still();
  if (homing || !result || !*result)
    return result ? std::nullopt : result;
  if (!std::exchange(homed_, true)) {
    arrived_s_ = axes_->time_s();
    zoom(settings_.magnification);
    return std::nullopt;
  }
  Frame& frame = **result;
  if (const std::string wrong = focus_complaint(frame.image); !wrong.empty()) {
    stand_still();
    return tl::unexpected(wrong);
  }
  const cv::Mat grey = focus_grey(frame.image);
  adopt(grey.size());
  const bool usable = settings_.law == FocusLaw::kThesis ? drive_by_printed_law(grey) : focus_on(grey);
  if (!usable) return std::nullopt;
  frame.image = correction_.apply(frame.image);
  frame.metres_per_pixel = autofocus_.metres_per_pixel(axes_->positions_m());
  frame.settles = true;
  return result;
}

std::vector<std::pair<std::string, double>> ImagingCamera::values() const {
  const AxisPositions axes = axes_->positions_m();
  const double metres_per_pixel = autofocus_.metres_per_pixel(axes);
  const bool printed = settings_.law == FocusLaw::kThesis;
  const Sharpness& sharpness = printed ? printed_sharpness_ : autofocus_.sharpness();
  return {{"imaging_state", printed ? kPrintedLaw : static_cast<double>(autofocus_.state())},
          {"focus_verdict", static_cast<double>(autofocus_.result().verdict)},
          {"focus_pictures", autofocus_.pictures()},
          {"focus_locks", autofocus_.locks()},
          {"sharpness_variance", sharpness.variance},
          {"sharpness_tenengrad", sharpness.tenengrad},
          {"focus_mm", 1e3 * axes.focus_m},
          {"zoom", axes.magnification_m / settings_.model.magnification_travel_m},
          {"magnification", settings_.model.optics.magnification(metres_per_pixel)},
          {"pixel_um", 1e6 * metres_per_pixel}};
}

ImagingCamera::Source simulated_source(const ImagingModel& model, const cv::Mat& picture, double width_m) {
  MicroscopeSettings settings;
  settings.picture = {640, 480};
  const ImagingModel lens = simulated_model();
  settings.model = model;
  if (PictureCorrection(model).idle()) {  // a lens is never perfect; a calibrated one is as it was found
    settings.model.distortion = lens.distortion;
    settings.model.flat_field = lens.flat_field;
  }
  Object object;
  object.metres_per_texel = width_m / picture.cols;
  focus_grey(picture).convertTo(object.texture, CV_32F);
  auto scope = std::make_shared<SimulatedMicroscope>(settings, object);
  return [scope](const AxisPositions& optics, double time_s) -> Camera::Result {
    return Frame{
        .source = "microscope", .file = "", .image = scope->picture(optics, time_s), .settles = true};
  };
}

ImagingCamera::Source camera_source(std::unique_ptr<Camera> camera) {
  return [same = std::shared_ptr<Camera>(std::move(camera))](const AxisPositions&, double) {
    return same->next();
  };
}

}  // namespace telekerf::vision_process
