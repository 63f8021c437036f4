// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment contours: the thesis' figures 3.2 to 3.12 from the shipped pictures of one open and one
// closed contour.
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/geometry/circle_fit.h"
#include "common/geometry/curve_sampling.h"
#include "common/geometry/elliptic_fourier.h"
#include "common/reporting/picture_file.h"
#include "common/reporting/plot.h"
#include "common/robot/delta_kinematics.h"
#include "common/robot/robot_model.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/vision/export/overlay.h"
#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/extraction/edge_band.h"
#include "common/vision/raster/field.h"
#include "common/vision/raster/grey_plane.h"
#include "common/vision/raster/picture_file.h"
#include "common/vision/scaling.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"

namespace telekerf::experiments {
namespace {

using reporting::draw_figure;
using reporting::Figure;
using reporting::Line;
using reporting::Panel;

using geometry::Polyline;

constexpr double kSpeed = 0.05;  ///< m/s, as in figure 3.10
constexpr double kPeriod = 1e-3;
constexpr double kMillimetre = 1e3;

/// One drawing on its way through chapter 3.
struct Subject {
  std::string name;
  vision::Field field;
  cv::Mat band;
  vision::PixelContour pixels;
  Polyline metres;
};

Subject subject(const std::string& name) {
  const auto picture = vision::read_picture(find_resource("pictures", name, ".png").string());
  if (!picture) throw input_error(picture.error());
  const auto field = vision::make_field(*vision::grey_plane(picture->image));
  const auto found = vision::extract(picture->image, {.mode = vision::ExtractionMode::kThesis});
  if (!field || !found) throw input_error(fmt::format("{}: {}", name, field ? found.error() : field.error()));
  Subject out{name, *field, {}, found->contours.front(), {}};
  out.band = vision::edge_band(*field, out.pixels.width_px, out.pixels.width_px > 0.0);
  out.metres = vision::to_workpiece(
      out.pixels, vision::scale_for(out.pixels, picture->image.cols, picture->image.rows, {}));
  return out;
}

cv::Mat in_colour(const cv::Mat& grey) {
  cv::Mat eight;
  cv::Mat out;
  grey.convertTo(eight, CV_8U, grey.depth() == CV_32F ? 255.0 : 1.0);
  cv::cvtColor(eight, out, cv::COLOR_GRAY2BGR);
  return out;
}

cv::Point at(const Vec2& p) {
  return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))};
}

/// Pictures two by two: open left, closed right.
void write_pictures(const std::vector<cv::Mat>& pictures, const std::filesystem::path& file) {
  std::vector<cv::Mat> rows;
  for (std::size_t i = 0; i + 1 < pictures.size(); i += 2) {
    rows.emplace_back();
    cv::hconcat(pictures[i], pictures[i + 1], rows.back());
  }
  cv::Mat all;
  cv::vconcat(rows, all);
  reporting::write_picture(file, all);
}

Line line_of(const Polyline& line, const std::string& label = {}, Line::Style style = Line::Style::kSolid,
             double unit = kMillimetre) {
  Line out{.label = label, .style = style};
  for (const Vec2& p : line.points_m) {
    out.x.push_back(unit * p.x());
    out.y.push_back(unit * p.y());
  }
  if (line.closed && !line.points_m.empty()) {
    out.x.push_back(out.x.front());
    out.y.push_back(out.y.front());
  }
  return out;
}

Panel plane(const std::string& title, std::vector<Line> lines, const std::string& unit = "mm") {
  return {.title = title,
          .x_label = "x, " + unit,
          .y_label = "y, " + unit,
          .lines = std::move(lines),
          .equal_axes = true};
}

Panel over_time(const std::string& title, const std::vector<double>& values, const std::string& label) {
  Line line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.x.push_back(static_cast<double>(i) * kPeriod);
    line.y.push_back(kMillimetre * values[i]);
  }
  return {.title = title, .x_label = "time, s", .y_label = label, .lines = {line}};
}

std::vector<double> axis(const std::vector<Vec2>& points, int k) {
  std::vector<double> out;
  out.reserve(points.size());
  for (const Vec2& p : points) out.push_back(p[k]);
  return out;
}

Polyline circle(const Vec2& centre, double radius) {
  Polyline out{{}, true};
  for (int i = 0; i < 90; ++i) {
    out.points_m.push_back(centre + radius * Vec2(std::cos(i * M_PI / 45), std::sin(i * M_PI / 45)));
  }
  return out;
}

/// Part of a line, as a line.
Polyline part(const Polyline& line, std::size_t first, std::size_t count) {
  Polyline out;
  for (std::size_t i = 0; i < count && first + i < line.size(); ++i)
    out.points_m.push_back(line.points_m[first + i]);
  return out;
}

class Drawer {
 public:
  explicit Drawer(const std::filesystem::path& out)
      : out_(out), open_(subject("script-e")), closed_(subject("cam")) {}

  nlohmann::json draw() {
    from_pixels();
    scaling_and_resolution();
    open_in_time();
    descriptors();
    constraints();
    return result_;
  }

 private:
  std::filesystem::path file(const std::string& number) const { return out_ / ("figure-" + number + ".png"); }

  /// Figures 3.2 to 3.4.
  void from_pixels() {
    write_pictures({in_colour(open_.field.smooth), in_colour(closed_.field.smooth), in_colour(open_.band),
                    in_colour(closed_.band)},
                   file("3.2"));

    const std::array<const Subject*, 2> both{&open_, &closed_};
    std::vector<cv::Mat> starts;
    std::vector<cv::Mat> travelled;
    for (const Subject* s : both) {
      cv::Mat picture = in_colour(s->band);
      if (s == &open_) {
        cv::circle(picture, at(s->pixels.points_px.front()), 8, {0, 200, 0}, 2, cv::LINE_AA);
        cv::circle(picture, at(s->pixels.points_px.back()), 8, {60, 60, 255}, 2, cv::LINE_AA);
      } else if (const auto first = vision::first_in_evolving_square(s->band)) {
        const int k =
            std::min({first->x, first->y, picture.cols - 1 - first->x, picture.rows - 1 - first->y});
        for (int inset = 0; inset <= k; inset += std::max(1, k / 4)) {
          cv::rectangle(picture, {inset, inset}, {picture.cols - 1 - inset, picture.rows - 1 - inset},
                        {255, 160, 0}, 1);
        }
        cv::circle(picture, *first, 8, {0, 200, 0}, 2, cv::LINE_AA);
      }
      starts.push_back(picture);
      cv::Mat points = in_colour(s->band) * 0.5;
      for (std::size_t i = 0; i < s->pixels.points_px.size(); i += 40) {
        cv::circle(points, at(s->pixels.points_px[i]), 9, {255, 160, 0}, 1, cv::LINE_AA);
      }
      for (std::size_t i = 0; i < s->pixels.points_px.size(); i += 4) {
        cv::circle(points, at(s->pixels.points_px[i]), 1, {60, 60, 255}, -1);
      }
      travelled.push_back(points);
    }
    write_pictures(starts, file("3.3"));
    write_pictures(travelled, file("3.4"));
  }

  /// Figures 3.5 and 3.6.
  void scaling_and_resolution() {
    Figure scaling{.title = "3.5 from image to workpiece", .columns = 2};
    Figure doubling{.title = "3.6 resolution, doubled three times", .columns = 2};
    std::vector<Panel> after;
    for (const Subject* s : {&open_, &closed_}) {
      Polyline pixels{s->pixels.points_px, s->pixels.closed};
      scaling.panels.push_back(
          plane(s->name + ", image (y down)", {line_of(pixels, {}, Line::Style::kSolid, 1.0)}, "px"));
      after.push_back(plane(s->name + ", workpiece", {line_of(s->metres)}));
    }
    scaling.panels.insert(scaling.panels.end(), after.begin(), after.end());
    draw_figure(scaling, file("3.5"));
    after.clear();
    for (const Subject* s : {&open_, &closed_}) {
      const Polyline low = geometry::resampled_to(s->metres, 24);
      const Polyline high = geometry::doubled(low, 3);
      doubling.panels.push_back(
          plane(fmt::format("{}, {} points", s->name, low.size()), {line_of(low, {}, Line::Style::kPoints)}));
      after.push_back(plane(fmt::format("{}, {} points", s->name, high.size()),
                            {line_of(high, {}, Line::Style::kPoints)}));
    }
    doubling.panels.insert(doubling.panels.end(), after.begin(), after.end());
    draw_figure(doubling, file("3.6"));
  }

  /// Figures 3.7, 3.8 and 3.11.
  void open_in_time() {
    const double chord_m = 1.2e-3;
    const Polyline low = geometry::resampled(open_.metres, 0.5e-3);
    const auto few =
        geometry::chord_steps(low, geometry::constant_speed(chord_m / kPeriod), {.period_s = kPeriod});
    const auto steps =
        geometry::chord_steps(open_.metres, geometry::constant_speed(kSpeed), {.period_s = kPeriod});
    if (!few || !steps) throw input_error(few ? steps.error() : few.error());
    Polyline points = part(low, 10, 12);
    std::vector<Line> chords{line_of(points, "P"), line_of(points, {}, Line::Style::kPoints)};
    for (const Vec2& p : few->points_m) {
      const auto box = geometry::bounding_box(points.points_m);
      if ((p.array() < box.min.array()).any() || (p.array() > box.max.array()).any()) continue;
      chords.push_back(
          line_of(circle(p, chord_m), chords.size() == 2 ? "R = V T" : "", Line::Style::kDashed));
      chords.back().colour = 2;
    }
    draw_figure({.title = "3.7 steps of equal chord",
                 .panels = {plane("", chords)},
                 .panel_width_px = 640,
                 .panel_height_px = 520},
                file("3.7"));
    draw_figure({.title = fmt::format("3.8 {} at {} mm/s", open_.name, kMillimetre * kSpeed),
                 .panels = {plane("points", {line_of(open_.metres)}),
                            over_time("x(t)", axis(steps->points_m, 0), "x, mm"),
                            over_time("y(t)", axis(steps->points_m, 1), "y, mm")},
                 .columns = 3},
                file("3.8"));
    result_["open"] = {{"points", open_.metres.size()},
                       {"length_m", geometry::length_m(open_.metres)},
                       {"steps", steps->points_m.size()}};

    const robot::RobotModel model = robot::load_robot("slave-keops");
    const robot::DeltaKinematics kinematics(model.geometry);
    const auto joints = geometry::to_joint_space(
        steps->points_m, 0.0, [&](const Eigen::Vector3d& tool_in_workpiece, Eigen::Vector3d& q) {
          const auto inverse = kinematics.inverse(model.in_base(tool_in_workpiece));
          if (inverse) q = *inverse;
          return inverse.has_value();
        });
    if (!joints) throw input_error(joints.error());
    Figure figure{.title = "3.11 from tool to joints", .columns = 3};
    figure.panels = {over_time("x(t)", axis(steps->points_m, 0), "x, mm"),
                     over_time("y(t)", axis(steps->points_m, 1), "y, mm")};
    for (int k = 0; k < 3; ++k) {
      std::vector<double> q;
      for (const Eigen::Vector3d& j : *joints) q.push_back(j[k]);
      figure.panels.push_back(over_time(fmt::format("joint {}", k + 1), q, "d, mm"));
    }
    draw_figure(figure, file("3.11"));
  }

  /// Figures 3.9 and 3.10.
  void descriptors() {
    Figure figure{.title = "3.9 elliptic Fourier descriptors", .columns = 2};
    nlohmann::json deviations = nlohmann::json::object();
    const auto curve_of = [&](std::size_t harmonics) {
      auto efd = geometry::fit_elliptic_fourier(closed_.metres, harmonics);
      if (!efd) throw input_error(efd.error());
      return *efd;
    };
    for (const std::size_t harmonics : {2U, 5U, 10U, 30U}) {
      const auto efd = curve_of(harmonics);
      Polyline curve{{}, true};
      for (int i = 0; i < 720; ++i) curve.points_m.push_back(efd.position(i * M_PI / 360));
      Line points = line_of(closed_.metres, "contour", Line::Style::kDashed);
      const double deviation = geometry::largest_deviation_m(efd, closed_.metres);
      deviations[std::to_string(harmonics)] = deviation;
      figure.panels.push_back(
          plane(fmt::format("{} harmonics, {:.3f} mm", harmonics, kMillimetre * deviation),
                {points, line_of(curve, "descriptors")}));
    }
    draw_figure(figure, file("3.9"));

    const geometry::EllipticFourierPath path(curve_of(30));
    std::vector<Vec2> points;
    Polyline curve{{}, true};
    for (double s = 0.0; s < path.length_m(); s += kSpeed * kPeriod) points.push_back(path.at(s).position);
    curve.points_m = points;
    draw_figure(
        {.title = fmt::format("3.10 {} at {} mm/s", closed_.name, kMillimetre * kSpeed),
         .panels = {plane("30 harmonics", {line_of(closed_.metres, "contour", Line::Style::kDashed),
                                           line_of(curve, "descriptors")}),
                    over_time("x(t)", axis(points, 0), "x, mm"), over_time("y(t)", axis(points, 1), "y, mm")},
         .columns = 3},
        file("3.10"));
    result_["closed"] = {{"points", closed_.metres.size()},
                         {"length_m", geometry::length_m(closed_.metres)},
                         {"largest_deviation_m", deviations}};
  }

  /// Figure 3.12.
  void constraints() {
    const Polyline& line = open_.metres;
    std::vector<Line> lines{line_of(line, open_.name)};
    for (std::size_t i = line.size() / 14; i < line.size(); i += line.size() / 7) {
      const auto fit = geometry::fit_circle(geometry::window(line, i, 12).view());
      if (fit.is_line || fit.radius_m > 0.02) continue;
      lines.push_back(line_of(circle(fit.centre_m, fit.radius_m), {}, Line::Style::kDashed));
      lines.push_back({.x = {kMillimetre * fit.point_m.x()},
                       .y = {kMillimetre * fit.point_m.y()},
                       .style = Line::Style::kPoints});
    }
    draw_figure({.title = "3.12 circles that constrain the hand",
                 .panels = {plane("", lines)},
                 .panel_width_px = 640,
                 .panel_height_px = 560},
                file("3.12"));
  }

  std::filesystem::path out_;
  Subject open_;
  Subject closed_;
  nlohmann::json result_;
};

struct Options : QuickForm {
  std::uint64_t seed = 1;
  std::string out;
};

/// What vision finds in four of the shipped pictures, over them.
void draw_found(const std::filesystem::path& png) {
  std::vector<cv::Mat> pictures;
  for (const char* name : {"heart", "gear", "script-e", "flange"}) {
    const auto loaded = vision::load_contours(find_resource("pictures", name, ".png"), {});
    if (!loaded) throw input_error(loaded.error());
    pictures.emplace_back();
    cv::resize(vision::overlay_of(*loaded), pictures.back(), {400, 300}, 0, 0, cv::INTER_AREA);
  }
  write_pictures(pictures, png);
}

}  // namespace

void add_contours_command(Program& program) {
  program.add(
      "contours",
      "Thesis 3: from picture to path, figures 3.2 to 3.12, and contours.png over shipped pictures",
      Options{},
      [](Options& o, Settings& s) {
        s.add("seed", o.seed, kSeeds, "nothing is drawn at random here");
        o.add_quick(s);
        s.add("out", o.out, kFolder, "for the figures").must_be_given();
      },
      [](const Options& o) {
        make_folder("--out", o.out);
        draw_found(std::filesystem::path(o.out) / "contours.png");
        std::cout << json_text(Drawer(o.out).draw()) << '\n';
        return 0;
      });
}

}  // namespace telekerf::experiments
