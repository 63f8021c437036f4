// SPDX-License-Identifier: Apache-2.0
// What the camera shows -> which contour is published, and when: on change only.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "slave/vision/cameras/camera.h"
#include "slave/vision/contour_source.h"
#include "slave/vision/hand_drawing.h"
#include "slave/vision/look.h"
#include "slave/vision/preview.h"

namespace telekerf::vision_process {

/// The same drawing: of each line no point lies further than `tolerance_m` from its like, and both are as
/// long. The start, the direction and the order of the further lines do not matter.
bool same_contour(const ContourMessage& a, const ContourMessage& b, double tolerance_m);

class VisionNode {
 public:
  enum class State {
    kWaiting,    ///< nothing seen yet
    kSeeing,     ///< the newest frame shows the published contour, or one that is about to be
    kNoContour,  ///< the newest frame shows none that can be machined; the published one stands
    kGone,       ///< no camera; the published one stands
  };
  /// Frames of a live camera that must agree before a contour counts: a hand in the picture is none.
  static constexpr int kAgreeing = 3;

  explicit VisionNode(ContourRequest request) : started_(request), request_(std::move(request)) {}

  struct Outcome {
    std::optional<ContourMessage> publish;
    std::string remark;  ///< for people, when something has changed; else empty
  };
  Outcome step(const Camera::Result& result);
  /// Looks at the newest picture anew, as somebody says (look.h), or takes what somebody draws over it: "draw
  /// X,Y X,Y ..." adds to it, "draw" forgets it, "draw open" and "draw closed" make a contour of it, which
  /// stands until the next look. The error is one sentence; everything stays as it was.
  tl::expected<Outcome, std::string> look(std::string_view words);
  /// The newest picture, for people; nothing of drawings, and before there is one.
  std::optional<PreviewMessage> preview() const;

  State state() const noexcept { return state_; }
  /// The newest frame shows the published contour where it was published.
  bool confirms() const noexcept { return state_ == State::kSeeing && published_ && !candidate_ && !drawn_; }
  int frames() const noexcept { return frames_; }
  int published() const noexcept { return published_count_; }
  int losses() const noexcept { return losses_; }  ///< times the camera was gone
  /// The quality record: deviation and size of what is published, contrast and noise of the newest picture,
  /// the threshold that is asked for (0: none, it is found).
  TelemetryMessage record() const;

 private:
  tl::expected<Outcome, std::string> draw(std::string_view words);
  tl::expected<ContourMessage, std::string> contour_in(const Frame& frame);
  Outcome enter(State state, const std::string& reason);

  ContourRequest started_;
  ContourRequest request_;
  std::optional<Frame> frame_;  ///< the newest
  cv::Mat picture_;
  Sight sight_;
  HandDrawing drawing_;
  bool drawn_ = false;  ///< the published contour was drawn by hand: no picture confirms it
  State state_ = State::kWaiting;
  std::optional<ContourMessage> published_;
  std::optional<ContourMessage> candidate_;
  std::string remarks_;
  double contrast_ = 0.0;
  double noise_ = 0.0;
  int agreeing_ = 0;  ///< frames that show `candidate_`
  int frames_ = 0;
  int published_count_ = 0;
  int losses_ = 0;
};

}  // namespace telekerf::vision_process
