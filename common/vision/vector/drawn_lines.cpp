// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/drawn_lines.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "common/vision/vector/doubles.h"
#include "common/vision/vector/joining.h"

namespace telekerf::vision {
namespace {

constexpr double kSame_m = 1e-12;  ///< a full turn ends where it began, but for rounding
constexpr double kFlat = 1e-6;     ///< area over the square of the length: no area
constexpr double kLiesOn = 0.2;    ///< of the distance that joins ends: lines as near as this are one

/// Twice the area, the line closed or not.
double area_of(const geometry::Polyline& line) {
  return std::abs(geometry::signed_area_m2({line.points_m, true}));
}

bool among(const std::vector<std::string>& words, const std::string& word) {
  const auto lower = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
  };
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& w) { return lower(w) == lower(word); });
}

/// "2 on a layer that is frozen, 1 hidden"
std::string counted(const std::vector<LeftOut>& left_out) {
  std::map<std::string, std::size_t> counts;
  for (const LeftOut& l : left_out) ++counts[l.why];
  std::string out;
  for (const auto& [why, times] : counts) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", times, why);
  return out;
}

}  // namespace

void DrawnLines::fail(std::string sentence) {
  if (!left_out_why.empty()) return unsupported.add("damaged and not shown");
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
  const std::size_t points = line.size();
  for (Vec2& p : line.points_m) p = metres_.cwiseProduct(here * p);
  if (!geometry::all_finite(line.points_m)) return fail("a coordinate is not a finite number");
  line = geometry::without_duplicates(line, closed ? kSame_m : 0.0);
  if (line.size() < 2) return;
  if (fills && !closed) {
    const double length = geometry::length_m(line);
    if (area_of(line) > kFlat * length * length) {
      line.closed = true;
      line = geometry::without_duplicates(line, kSame_m);
    }
  }
  points_ += points;
  lines_.push_back(std::move(line));
  pens_.push_back(pen);
  why_.push_back(left_out_why);
}

/// Leaves out what is on no layer and of no colour that is asked for.
void DrawnLines::choose() {
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    if (!why_[k].empty()) continue;
    if (!request_.layers.empty() && !among(request_.layers, pens_[k].layer))
      why_[k] = "on a layer that was not asked for";
    if (!request_.colours.empty() && !among(request_.colours, pens_[k].colour))
      why_[k] = "of a colour that was not asked for";
  }
}

std::string DrawnLines::none(std::string_view format, const VectorDrawing& drawing) const {
  std::string out = fmt::format("the {} file draws no line", format);
  if (!unsupported.empty())
    out += fmt::format(" that is understood (not followed: {})", unsupported.sentence());
  if (!drawing.left_out.empty())
    out += fmt::format(" that is to be cut (left out: {})", counted(drawing.left_out));
  return out;
}

tl::expected<VectorDrawing, std::string> DrawnLines::drawing(std::string_view format) {
  if (failed()) return tl::unexpected(complaint_);
  choose();
  VectorDrawing out;
  out.unsupported = unsupported;
  std::vector<geometry::Polyline> kept;
  std::vector<std::size_t> kept_from;
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    if (why_[k].empty()) {
      kept.push_back(std::move(lines_[k]));
      kept_from.push_back(k);
    } else {
      out.left_out.push_back({std::move(lines_[k]), pens_[k], why_[k]});
    }
  }
  if (kept.empty()) return tl::unexpected(none(format, out));
  WithoutDoubles once = without_doubles(std::move(kept), kLiesOn * request_.join_m);
  for (std::size_t i = 0; i < once.doubles.size(); ++i) {
    out.left_out.push_back({std::move(once.doubles[i]), pens_[kept_from[once.doubles_from[i]]],
                            "drawn twice: it lies on another line"});
  }
  if (once.gave_up) notes.push_back("too many lines in one place to look for some that are drawn twice");
  Joined joined_lines = joined(std::move(once.lines), request_.join_m);
  out.contours = std::move(joined_lines.lines);
  for (const std::size_t i : joined_lines.first) out.pens.push_back(pens_[kept_from[once.from[i]]]);
  out.joined = joined_lines.ends / 2;
  if (out.joined > 0) notes.push_back(fmt::format("{} pairs of ends were joined", out.joined));
  const auto open =
      std::count_if(out.contours.begin(), out.contours.end(), [](const auto& c) { return !c.closed; });
  if (open > 0) notes.push_back(fmt::format("{} of {} contours are open", open, out.contours.size()));
  if (!out.left_out.empty()) notes.push_back("left out: " + counted(out.left_out));
  out.notes = std::move(notes);
  return out;
}

}  // namespace telekerf::vision
