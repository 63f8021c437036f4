// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/drawn_lines.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>
#include <utility>

#include "common/vision/vector/joining.h"

namespace telekerf::vision {
namespace {

constexpr double kSame_m = 1e-12;  ///< a full turn ends where it began, but for rounding
constexpr double kMeets_m = 1e-8;

}  // namespace

void DrawnLines::fail(std::string sentence) {
  if (complaint_.empty()) complaint_ = std::move(sentence);
}

std::optional<CurveWriter> DrawnLines::writer(const Eigen::Affine2d& here) {
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(here.linear());
  const double magnification = svd.singularValues()[0] * metres_.cwiseAbs().maxCoeff();
  if (!std::isfinite(magnification)) fail("a scale is not finite");
  if (failed() || !(magnification > 0.0)) return std::nullopt;
  return CurveWriter(limits_.chord_error_m / magnification, limits_.max_points - points_);
}

void DrawnLines::add(CurveWriter& writer, const Eigen::Affine2d& here, bool closed) {
  if (writer.bad()) return fail("a coordinate is not a finite number");
  if (writer.full()) return fail(fmt::format("the drawing has more than {} points", limits_.max_points));
  geometry::Polyline line{writer.take(), closed};
  points_ += line.size();
  for (Vec2& p : line.points_m) p = metres_.cwiseProduct(here * p);
  if (!geometry::all_finite(line.points_m)) return fail("a coordinate is not a finite number");
  line = geometry::without_duplicates(line, closed ? kSame_m : 0.0);
  if (line.size() >= 2) lines_.push_back(std::move(line));
}

tl::expected<VectorDrawing, std::string> DrawnLines::drawing(std::string_view format) {
  if (failed()) return tl::unexpected(complaint_);
  if (lines_.empty()) {
    const std::string none = fmt::format("the {} file draws no line", format);
    if (unsupported.empty()) return tl::unexpected(none);
    return tl::unexpected(
        fmt::format("{} that is understood (not followed: {})", none, unsupported.sentence()));
  }
  VectorDrawing out;
  out.contours = joined(std::exchange(lines_, {}), kMeets_m);
  out.unsupported = unsupported;
  return out;
}

}  // namespace telekerf::vision
