// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/guide_path.h"

#include <algorithm>
#include <cmath>

#include "common/runtime/startup_error.h"
#include "master/constraint/guide_curve.h"

namespace telekerf::master {
namespace {

std::optional<geometry::EllipticFourierPath> descriptor_of(const geometry::Polyline& line,
                                                           const ConstraintSettings& settings) {
  if (settings.curve != CurveKind::kDescriptor) return std::nullopt;
  if (!line.closed) throw input_error("a descriptor needs a closed contour; use --curve circles");
  const auto chosen = geometry::choose_harmonics(line, settings.descriptor_error_m);
  if (!chosen) throw input_error("no descriptor of this contour: " + chosen.error());
  return std::optional<geometry::EllipticFourierPath>(chosen->curve);
}

}  // namespace

GuidePath::GuidePath(const ContourMessage& message, double scale, const ConstraintSettings& settings)
    : contour_id(message.id),
      beta(scale),
      contour(scaled_contour(message, scale)),
      curve(guide_curve(message, scale, settings)),
      descriptor_(descriptor_of(curve.line(), settings)),
      spacing_m_(curve.length_m() / static_cast<double>(curve.line().segments())),
      length_m_(descriptor_ ? descriptor_->length_m() : curve.length_m()),
      circles_(curve.line(), spacing_m_, settings),
      limits_(curve.line(), spacing_m_, settings,
              [this](double fraction) { return at(length_m_ * fraction).shape.curvature(); }) {}

double GuidePath::wrapped(double arc_m) const noexcept {
  if (!closed()) return std::clamp(arc_m, 0.0, length_m_);
  const double arc = std::fmod(arc_m, length_m_);
  return arc < 0.0 ? arc + length_m_ : arc;
}

double GuidePath::find(const Vec2& tool_m) const noexcept { return refined(tool_m, curve.find(tool_m)); }

double GuidePath::find_near(const Vec2& tool_m, double arc_m) const noexcept {
  const double share = wrapped(arc_m) / length_m_;
  const auto segment = static_cast<std::size_t>(share * static_cast<double>(curve.line().segments()));
  return refined(tool_m, curve.find_near(tool_m, segment));
}

double GuidePath::refined(const Vec2& tool_m, const geometry::Nearest& nearest) const noexcept {
  const auto segments = static_cast<double>(curve.line().segments());
  double arc = length_m_ * (static_cast<double>(nearest.segment) + nearest.along) / segments;
  for (int i = 0; i < 4; ++i) {
    const GuidePiece piece = at(arc);
    const double step = piece.shape.tangent(tool_m).dot(tool_m - piece.point_m);
    arc = wrapped(arc + std::clamp(step, -2.0 * spacing_m_, 2.0 * spacing_m_));
  }
  return arc;
}

GuidePiece GuidePath::at(double arc_m) const noexcept {
  const double arc = wrapped(arc_m);
  return descriptor_ ? described(arc) : circles_.at(curve.line(), arc);
}

GuidePiece GuidePath::described(double arc_m) const noexcept {
  const geometry::CurveState state = descriptor_->at(arc_m);
  const Vec2 tangent = state.first.normalized();
  return {arc_m, state.position,
          geometry::osculating(state.position, tangent, geometry::cross(tangent, state.second))};
}

SpeedLimit GuidePath::speed_limit(double arc_m) const noexcept {
  return limits_.at(wrapped(arc_m) / length_m_);
}

}  // namespace telekerf::master
