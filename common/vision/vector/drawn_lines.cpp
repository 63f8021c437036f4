// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/drawn_lines.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "common/vision/vector/colour_names.h"
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

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// A layer within others, "part/holes", is meant by its whole name, by that of one it lies in, and by the
/// last of its names alone.
bool is_layer(const std::string& asked, const std::string& layer) {
  const std::string word = in_lower_case(asked);
  const std::string name = in_lower_case(layer);
  return name == word || ("/" + name + "/").find("/" + word + "/") != std::string::npos;
}

/// "red", "#F00" and "#ff0000" are one.
std::string plain_colour(const std::string& colour) {
  const std::string c = in_lower_case(colour);
  if (c.size() == 4 && c[0] == '#') return fmt::format("#{0}{0}{1}{1}{2}{2}", c[1], c[2], c[3]);
  return named_colour(c).value_or(c);
}

bool is_colour(const std::string& asked, const std::string& colour) {
  return plain_colour(asked) == plain_colour(colour);
}

/// "cut, \"fold lines\"": the first of them, in order.
std::string list_of(const std::set<std::string>& words) {
  constexpr std::size_t kMost = 12;
  std::string out;
  std::size_t count = 0;
  for (const std::string& word : words) {
    if (++count > kMost) return out + ", ..";
    out += fmt::format("{}\"{:.40}\"", out.empty() ? "" : ", ", word);
  }
  return out;
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
  if (line.size() < 2) {
    dots_ += left_out_why.empty();
    return;
  }
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

/// Leaves out what is on no layer and of no colour that is asked for. A word that nothing answers to is a
/// slip of the hand.
void DrawnLines::choose() {
  std::set<std::string> layers;
  std::set<std::string> colours;
  for (const Pen& p : pens_) {
    layers.insert(p.layer);
    colours.insert(p.colour);
  }
  for (const std::string& asked : request_.layers) {
    if (std::none_of(layers.begin(), layers.end(), [&](const auto& l) { return is_layer(asked, l); }))
      return fail(fmt::format("--layers {}: nothing is drawn on a layer of that name; there are {}", asked,
                              list_of(layers)));
  }
  for (const std::string& asked : request_.colours) {
    if (std::none_of(colours.begin(), colours.end(), [&](const auto& c) { return is_colour(asked, c); }))
      return fail(fmt::format("--colours {}: nothing is drawn in that colour; there are {}", asked,
                              list_of(colours)));
  }
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    if (!why_[k].empty()) continue;
    const auto wanted = [](const std::vector<std::string>& words, const std::string& own, auto same) {
      return words.empty() ||
             std::any_of(words.begin(), words.end(), [&](const auto& word) { return same(word, own); });
    };
    if (!wanted(request_.layers, pens_[k].layer, is_layer)) why_[k] = "on a layer that was not asked for";
    if (!wanted(request_.colours, pens_[k].colour, is_colour)) why_[k] = "of a colour that was not asked for";
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
  if (failed()) return tl::unexpected(complaint_);
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
  if (dots_ > 0) notes.push_back(fmt::format("left out: {} without any length", dots_));
  out.notes = std::move(notes);
  return out;
}

}  // namespace telekerf::vision
