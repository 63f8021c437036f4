// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "common/geometry/nearest.h"

namespace telekerf::vision_process {
namespace {

/// A line is meant by who points this near to it, as a share of the diagonal of all that is shown.
constexpr double kFinger = 0.02;

std::optional<double> number_in(std::string_view text) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, wrong] = std::from_chars(text.data(), end, number);
  if (wrong != std::errc() || rest != end) return std::nullopt;
  return number;
}

std::optional<Vec2> place_in(std::string_view text) {
  Vec2 place_m;
  const char* const end = text.data() + text.size();
  const auto x = std::from_chars(text.data(), end, place_m.x());
  if (x.ec != std::errc() || x.ptr == end || *x.ptr != ',') return std::nullopt;
  const auto y = std::from_chars(x.ptr + 1, end, place_m.y());
  if (y.ec != std::errc() || y.ptr != end || !place_m.allFinite()) return std::nullopt;
  return place_m;
}

bool holds(const geometry::Polyline& line, const Vec2& place_m) {
  if (!line.closed || line.size() < 3) return false;
  std::vector<cv::Point2f> points;
  points.reserve(line.size());
  for (const Vec2& p : line.points_m)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  const cv::Point2f place(static_cast<float>(place_m.x()), static_cast<float>(place_m.y()));
  return cv::pointPolygonTest(points, place, false) >= 0.0;
}

double area_m2(const geometry::Polyline& line) { return std::abs(geometry::signed_area_m2(line)); }

/// Which of the further contours is meant: the smallest around the place, or the line beside it.
std::optional<std::size_t> further_at(const ContourMessage& shown, const Vec2& place_m) {
  std::vector<Vec2> all = shown.points_m;
  for (const ContourLine& line : shown.further)
    all.insert(all.end(), line.points_m.begin(), line.points_m.end());
  const double finger_m = kFinger * geometry::bounding_box(all).size().norm();
  std::optional<std::size_t> around, beside;
  double smallest_m2 = std::numeric_limits<double>::infinity();
  double nearest_m = finger_m;
  // Inside the chosen contour only what is smaller is meant otherwise.
  const geometry::Polyline chosen{shown.points_m, shown.closed};
  if (holds(chosen, place_m)) smallest_m2 = area_m2(chosen);
  for (std::size_t i = 0; i < shown.further.size(); ++i) {
    const geometry::Polyline line{shown.further[i].points_m, shown.further[i].closed};
    if (line.size() < 2) continue;
    if (holds(line, place_m) && area_m2(line) < smallest_m2) {
      smallest_m2 = area_m2(line);
      around = i;
    }
    if (const double away_m = geometry::NearestIndex(line).find(place_m).distance_m; away_m < nearest_m) {
      nearest_m = away_m;
      beside = i;
    }
  }
  return around ? around : beside;
}

/// The numbers of --select count the chosen one too, in whose place the further ones close up.
std::size_t number_of(std::size_t further, std::size_t selected) {
  return further < selected ? further : further + 1;
}

}  // namespace

std::optional<std::vector<Vec2>> places_in(std::string_view words) {
  std::vector<Vec2> places_m;
  while (!words.empty()) {
    const std::size_t space = std::min(words.find(' '), words.size());
    const std::optional<Vec2> place_m = place_in(words.substr(0, space));
    if (!place_m) return std::nullopt;
    places_m.push_back(*place_m);
    words.remove_prefix(std::min(space + 1, words.size()));
  }
  return places_m;
}

tl::expected<ContourRequest, std::string> looked_at(std::string_view words, const ContourRequest& started,
                                                    ContourRequest now, const ContourMessage& shown,
                                                    const Sight& sight) {
  const std::size_t space = words.find(' ');
  const std::string_view word = words.substr(0, space);
  const std::string_view rest = space == words.npos ? std::string_view() : words.substr(space + 1);
  if (word == "anew" && rest.empty()) return started;
  if (word == "mode") {
    const auto mode = vision::kExtractionModes.find(rest);
    if (!mode) {
      return tl::unexpected(
          fmt::format("no mode of the name '{}' (telekerf-vision --help has the names at --mode)", rest));
    }
    if (!sight.pixels) return tl::unexpected<std::string>("a drawing says its lines itself; it has no mode");
    now.mode = *mode;
    now.select = 0;
    return now;
  }
  if (word == "level") {
    if (!sight.pixels) return tl::unexpected<std::string>("a drawing says its lines itself; it has no level");
    const auto share = number_in(rest);
    if (!rest.empty() && !(share && *share >= vision::kLevels.min && *share <= vision::kLevels.max))
      return tl::unexpected(fmt::format("level = {}: must lie within [{:g}, {:g}]", rest, vision::kLevels.min,
                                        vision::kLevels.max));
    now.picture.level = share;
    now.select = 0;
    return now;
  }
  const std::optional<Vec2> place_m = place_in(rest);
  if ((word != "at" && word != "start" && word != "end") || !place_m) {
    return tl::unexpected(
        fmt::format("'{}' is no look; it is one of at X,Y; start X,Y; end X,Y (metres); mode WORD; level "
                    "SHARE; draw X,Y X,Y ..; draw open; draw closed; anew",
                    words));
  }
  if (word == "at") {
    if (const auto further = further_at(shown, *place_m)) {
      now.select = number_of(*further, now.select);
      now.start_px.reset();
      now.end_px.reset();
      return now;
    }
  }
  if (!sight.pixels) return tl::unexpected<std::string>("no line of the drawing is there");
  if (now.picture.paper != vision::Paper::kNone) {
    return tl::unexpected<std::string>(
        "of a sheet that lies askew the pixels are not known afterwards; start vision with --at X,Y");
  }
  const Vec2 pixel = sight.reduction * sight.scale.to_picture(*place_m);
  if (word == "at") {
    now.picture.at = {pixel.x(), pixel.y()};
    now.picture.away.clear();
    now.picture.box.clear();
    now.select = 0;
    now.start_px.reset();
    now.end_px.reset();
  } else if (word == "start") {
    now.start_px = pixel;
  } else {
    now.end_px = pixel;
  }
  return now;
}

}  // namespace telekerf::vision_process
