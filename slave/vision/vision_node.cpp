// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/vision_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/nearest.h"

namespace telekerf::vision_process {
namespace {

constexpr double kSame_px = 2.0;         ///< a contour that moves less has not changed
constexpr double kSameScale = 0.01;      ///< of a pixel's size, where the camera says it
constexpr double kSameDrawing_m = 1e-6;  ///< for drawings, which have no pixels

double tolerance_for(const ContourMessage& contour) {
  return std::max(kSameDrawing_m, kSame_px * contour.metres_per_pixel + 4.0 * contour.deviation_m);
}

double furthest(const std::vector<Vec2>& from, const geometry::NearestIndex& to) {
  double out = 0.0;
  for (const Vec2& p : from) out = std::max(out, to.find(p).distance_m);
  return out;
}

bool same_line(const geometry::Polyline& a, const geometry::Polyline& b, double tolerance_m) {
  if (a.closed != b.closed) return false;
  const double length_a = geometry::length_m(a);
  const double length_b = geometry::length_m(b);
  if (std::abs(length_a - length_b) > 0.02 * std::max(length_a, length_b) + 2.0 * tolerance_m) return false;
  return furthest(a.points_m, geometry::NearestIndex(b)) <= tolerance_m &&
         furthest(b.points_m, geometry::NearestIndex(a)) <= tolerance_m;
}

/// Each line of one is a line of the other; their order may differ, lines of the same length change places.
bool all_among(const std::vector<ContourLine>& these, const std::vector<ContourLine>& those,
               double tolerance_m) {
  return std::all_of(these.begin(), these.end(), [&](const ContourLine& a) {
    return std::any_of(those.begin(), those.end(), [&](const ContourLine& b) {
      return same_line({a.points_m, a.closed}, {b.points_m, b.closed}, tolerance_m);
    });
  });
}

/// A camera that has zoomed shows the same lines with other pixels: finer or coarser ones.
bool same_scale(const ContourMessage& a, const ContourMessage& b) {
  return std::abs(a.metres_per_pixel - b.metres_per_pixel) <= kSameScale * a.metres_per_pixel;
}

}  // namespace

bool same_contour(const ContourMessage& a, const ContourMessage& b, double tolerance_m) {
  return a.further.size() == b.further.size() &&
         same_line({a.points_m, a.closed}, {b.points_m, b.closed}, tolerance_m) &&
         all_among(a.further, b.further, tolerance_m) && all_among(b.further, a.further, tolerance_m);
}

tl::expected<ContourMessage, std::string> VisionNode::contour_in(const Frame& frame) {
  vision::LoadRequest load = load_request(request_);
  if (frame.metres_per_pixel) load.scale.metres_per_pixel = frame.metres_per_pixel;
  const auto loaded =
      frame.file.empty() ? vision::contours_of(frame.image, load) : vision::load_contours(frame.file, load);
  if (!loaded) {
    if (frame.file.empty()) picture_ = frame.image;  // what is not understood is looked at all the more
    return tl::unexpected(loaded.error());
  }
  picture_ = loaded->picture;
  sight_ = {loaded->scale, loaded->reduction, !picture_.empty()};
  remarks_ = loaded->remarks;
  contrast_ = loaded->contrast;
  noise_ = loaded->picture_noise;
  auto message = message_of(*loaded, frame.source, request_.workspace_radius_m);
  if (message && message->further.size() + 1 < loaded->contours.size()) {
    remarks_ += fmt::format(
        "{}of {} contours the smallest {} are left out: a message holds {} further lines and {} points of "
        "them (--layers or --colours of a drawing, --smallest-mm of a picture choose what is cut)",
        remarks_.empty() ? "" : "; ", loaded->contours.size(),
        loaded->contours.size() - 1 - message->further.size(), kMaxContourLines, kMaxContourPoints);
  }
  return message;
}

tl::expected<VisionNode::Outcome, std::string> VisionNode::look(std::string_view words) {
  if (words == "draw" || words.starts_with("draw "))
    return draw(words.substr(std::min<std::size_t>(5, words.size())));
  if (!frame_ || !published_)
    return tl::unexpected<std::string>("there is no contour yet from which to go on");
  auto request = looked_at(words, started_, request_, *published_, sight_);
  if (!request) return tl::unexpected(request.error());
  std::swap(request_, *request);
  auto seen = contour_in(*frame_);
  if (!seen) {
    std::swap(request_, *request);
    return tl::unexpected(seen.error());
  }
  state_ = State::kSeeing;
  candidate_.reset();
  drawn_ = false;
  published_ = std::move(*seen);
  ++published_count_;
  return Outcome{published_, {}};
}

tl::expected<VisionNode::Outcome, std::string> VisionNode::draw(std::string_view words) {
  if (words.empty()) {
    drawing_.forget();
    return Outcome{};
  }
  if (words != "open" && words != "closed") {
    const auto places_m = places_in(words);
    if (!places_m)
      return tl::unexpected(fmt::format("'{}' are no places; they are X,Y X,Y .. in metres", words));
    if (!drawing_.add(*places_m))
      return tl::unexpected(fmt::format("what is drawn has more than {} places", HandDrawing::kMostPlaces));
    return Outcome{};
  }
  auto contour = drawing_.contour(words == "closed", request_.workspace_radius_m);
  drawing_.forget();
  if (!contour) return tl::unexpected(contour.error());
  drawn_ = true;
  candidate_.reset();
  published_ = std::move(*contour);
  ++published_count_;
  return Outcome{published_, {}};
}

std::optional<PreviewMessage> VisionNode::preview() const {
  if (picture_.empty()) return std::nullopt;
  if (sight_.pixels) {
    auto preview = preview_of(picture_, sight_.scale);
    if (preview && published_) preview->contour_id = published_->id;
    return preview;
  }
  // Nothing has been found in it yet: as a contour would be fitted.
  vision::ScaleRequest fit = load_request(request_).scale;
  vision::PixelContour whole;
  whole.points_px = {Vec2(0.0, 0.0), Vec2(picture_.cols - 1.0, picture_.rows - 1.0)};
  return preview_of(picture_, vision::scale_for(whole, picture_.cols, picture_.rows, fit));
}

TelemetryMessage VisionNode::record() const {
  TelemetryMessage out;
  out.role = "vision";
  out.tick = static_cast<Tick>(frames_);
  out.values = {{"frames", frames_},        {"published", published_count_},
                {"camera_losses", losses_}, {"camera_gone", state_ == State::kGone},
                {"contrast", contrast_},    {"picture_noise", noise_},
                {"level", request_.picture.level.value_or(0.0)}};
  if (!published_) return out;
  const geometry::Polyline line{published_->points_m, published_->closed};
  const Vec2 size = geometry::bounding_box(line.points_m).size();
  out.values.insert(out.values.end(), {{"contour_id", published_->id},
                                       {"deviation_mm", 1e3 * published_->deviation_m},
                                       {"length_mm", 1e3 * geometry::length_m(line)},
                                       {"width_mm", 1e3 * size.x()},
                                       {"height_mm", 1e3 * size.y()}});
  return out;
}

VisionNode::Outcome VisionNode::enter(State state, const std::string& reason) {
  const bool news = state != state_;
  state_ = state;
  candidate_.reset();
  if (!news) return {};
  return {std::nullopt, reason + (published_ ? "; the published contour stands" : "")};
}

VisionNode::Outcome VisionNode::step(const Camera::Result& result) {
  if (!result) {
    if (state_ != State::kGone) ++losses_;
    return enter(State::kGone, result.error());
  }
  if (!*result) return {};
  ++frames_;
  const Frame& frame = frame_.emplace(**result);
  if (drawn_) {
    if (frame.file.empty()) picture_ = frame.image;
    state_ = State::kSeeing;
    return {};
  }
  auto seen = contour_in(frame);
  if (!seen) return enter(State::kNoContour, seen.error());

  const bool back = state_ == State::kGone || state_ == State::kNoContour;
  state_ = State::kSeeing;
  Outcome out;
  if (back) out.remark = fmt::format("{}: the contour is seen again", frame.source);
  const bool scaled = frame.metres_per_pixel.has_value();
  if (published_ && same_contour(*published_, *seen, tolerance_for(*published_)) &&
      (!scaled || same_scale(*published_, *seen))) {
    candidate_.reset();
    return out;
  }
  const bool agrees = candidate_ && same_contour(*candidate_, *seen, tolerance_for(*candidate_)) &&
                      (!scaled || same_scale(*candidate_, *seen));
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  candidate_ = std::move(*seen);
  if (frame.settles && agreeing_ < kAgreeing) return out;
  published_ = std::exchange(candidate_, std::nullopt);
  ++published_count_;
  out.publish = published_;
  if (!remarks_.empty())
    out.remark += fmt::format("{}{}: {}", out.remark.empty() ? "" : "; ", frame.source, remarks_);
  return out;
}

}  // namespace telekerf::vision_process
