// SPDX-License-Identifier: Apache-2.0
// A camera above two axes: gives pictures that are in focus, with the size of their pixels, and none while
// the magnification moves or the focus is searched for.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slave/vision/cameras/camera.h"
#include "slave/vision/imaging/autofocus.h"
#include "slave/vision/imaging/axes_runner.h"
#include "slave/vision/imaging/focus_law.h"

namespace telekerf::vision_process {

struct ImagingCameraSettings {
  imaging::ImagingModel model;
  imaging::FocusLaw law = imaging::FocusLaw::kSearch;
  double magnification = 0.0;  ///< where the magnification axis goes first, share of its travel
  double region = 0.5;         ///< share of the picture that the focus is judged by
  double frame_period_s = 0.05;
  int late_frames = 0;  ///< that a camera still has of before, in its buffers
};

/// 8-bit grey levels of a picture of 8 or 16 bits with 1, 3 or 4 channels, always by the same gain: what the
/// focus is judged by.
cv::Mat focus_grey(const cv::Mat& picture);
/// Why the focus cannot be judged by such a picture, in one sentence; empty: it can.
std::string focus_complaint(const cv::Mat& picture);

class ImagingCamera final : public Camera {
 public:
  /// Pictures of whatever is under the axes, with the optics there; simulated or a camera's.
  using Source = std::function<Result(const imaging::AxisPositions& optics, double time_s)>;
  /// Waits for the next picture's moment; virtual time puts its own steps there.
  using Wait = std::function<void()>;

  ImagingCamera(const ImagingCameraSettings& settings, std::shared_ptr<imaging::AxesRunner> axes,
                Source source, Wait wait);

  Result next() override;

  /// Why zoom and refocus would do nothing now, and the remedy; empty: they do.
  std::string refusal() const;
  /// The magnification axis to a share of its travel, clamped to 0..1; the focus follows.
  void zoom(double share);
  /// Searches the focus anew.
  void refocus();

  /// Named numbers for people.
  std::vector<std::pair<std::string, double>> values() const;
  /// What has changed since the last call, in words; empty: nothing.
  std::string remark();
  const imaging::Autofocus& autofocus() const noexcept { return autofocus_; }

 private:
  bool focus_on(const cv::Mat& grey);
  bool drive_by_printed_law(const cv::Mat& grey);
  /// Another size of the pictures than before: what was seen of them does not count any more.
  void adopt(const cv::Size& size);
  /// The axes are on their way to their lower ends, or lost.
  bool homing();
  /// They have been on their way for longer than any way takes.
  bool axes_are_held();
  void say_state();
  /// Nothing is seen: nothing may go on by what was seen last.
  void stand_still();
  void note(std::string words);

  ImagingCameraSettings settings_;
  std::shared_ptr<imaging::AxesRunner> axes_;
  Source source_;
  Wait wait_;
  imaging::Autofocus autofocus_;
  imaging::PrintedFocusLaw printed_;
  imaging::Sharpness printed_sharpness_;  ///< of the newest picture that the printed law has seen
  imaging::PictureCorrection correction_;
  bool homed_ = false;
  bool lost_ = false;  ///< since they had homed, and not yet said
  int still_frames_ = 0;    ///< pictures since both axes stand still at their goals
  cv::Size size_;           ///< of the pictures
  double arrived_s_ = 0.0;  ///< axes' time when both were last where they were sent
  int excited_ = 0;         ///< pictures that the printed law has been excited for
  std::optional<double> focus_goal_m_;
  std::string said_;
  std::string remark_;
};

/// The simulated microscope over a picture that is `width_m` wide on the workpiece, as a source.
ImagingCamera::Source simulated_source(const imaging::ImagingModel& model, const cv::Mat& picture,
                                       double width_m);
/// A camera above real axes, as a source.
ImagingCamera::Source camera_source(std::unique_ptr<Camera> camera);

}  // namespace telekerf::vision_process
