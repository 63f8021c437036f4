// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/vision_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/nearest.h"

namespace telekerf::vision {
namespace {

constexpr double kSamePx = 2.0;        ///< a contour that moves less has not changed
constexpr double kSameDrawing = 1e-6;  ///< metres, for drawings, which have no pixels

double tolerance_for(const ContourMessage& contour) {
  return std::max(kSameDrawing, kSamePx * contour.metres_per_pixel + 4.0 * contour.deviation_m);
}

double furthest(const std::vector<Vec2>& from, const geometry::NearestIndex& to) {
  double out = 0.0;
  for (const Vec2& p : from) out = std::max(out, to.find(p).distance_m);
  return out;
}

}  // namespace

bool same_contour(const ContourMessage& a, const ContourMessage& b, double tolerance_m) {
  if (a.closed != b.closed) return false;
  const geometry::NearestIndex line_a({a.points_m, a.closed});
  const geometry::NearestIndex line_b({b.points_m, b.closed});
  const double longer = std::max(line_a.length_m(), line_b.length_m());
  if (std::abs(line_a.length_m() - line_b.length_m()) > 0.02 * longer + 2.0 * tolerance_m) return false;
  return furthest(a.points_m, line_b) <= tolerance_m && furthest(b.points_m, line_a) <= tolerance_m;
}

tl::expected<ContourMessage, std::string> VisionNode::contour_in(const Frame& frame) {
  const LoadRequest load = load_request(request_);
  const auto loaded = frame.file.empty() ? contours_of(frame.image, load) : load_contours(frame.file, load);
  if (!loaded) return tl::unexpected(loaded.error());
  contrast_ = loaded->contrast;
  noise_ = loaded->picture_noise;
  return message_of(*loaded, frame.source, request_.workspace_radius_m);
}

TelemetryMessage VisionNode::record() const {
  TelemetryMessage out;
  out.role = "vision";
  out.tick = static_cast<Tick>(frames_);
  out.values = {{"frames", frames_},        {"published", published_count_},
                {"camera_losses", losses_}, {"camera_gone", state_ == State::kGone},
                {"contrast", contrast_},    {"picture_noise", noise_}};
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
  agreeing_ = 0;
  candidate_.reset();
  if (!news) return {};
  return {std::nullopt, reason + (published_ ? "; the published contour stands" : "")};
}

VisionNode::Outcome VisionNode::step(const Camera::Look& look) {
  if (!look) {
    if (state_ != State::kGone) ++losses_;
    return enter(State::kGone, look.error());
  }
  if (!*look) return {};
  ++frames_;
  const Frame& frame = **look;
  auto seen = contour_in(frame);
  if (!seen) return enter(State::kNoContour, seen.error());

  const bool back = state_ == State::kGone || state_ == State::kNoContour;
  state_ = State::kSeeing;
  Outcome out;
  if (back) out.remark = fmt::format("{}: the contour is seen again", frame.source);
  if (published_ && same_contour(*published_, *seen, tolerance_for(*published_))) {
    agreeing_ = 0;
    candidate_.reset();
    return out;
  }
  const bool agrees = candidate_ && same_contour(*candidate_, *seen, tolerance_for(*candidate_));
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  candidate_ = std::move(*seen);
  if (frame.settles && agreeing_ < kAgreeing) return out;
  published_ = std::exchange(candidate_, std::nullopt);
  agreeing_ = 0;
  ++published_count_;
  out.publish = published_;
  return out;
}

}  // namespace telekerf::vision
