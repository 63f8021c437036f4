// SPDX-License-Identifier: Apache-2.0
#include "tools/inspect/robot_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/reporting/picture_file.h"
#include "common/runtime/startup_error.h"

namespace telekerf::inspect {
namespace {

constexpr int kPanel_px = 560;
constexpr int kHead_px = 40;
constexpr int kFoot_px = 60;
const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kGrid(225, 225, 225);
const cv::Scalar kOutline(160, 60, 20);

void text(cv::Mat& picture, const std::string& words, cv::Point at, double scale = 0.45) {
  cv::putText(picture, words, at, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, 1, cv::LINE_AA);
}

/// Green (1) over yellow to red (kWorstCondition and worse).
cv::Vec3b colour(double condition) {
  const double bad = std::clamp(std::log(condition) / std::log(robot::kWorstCondition), 0.0, 1.0);
  const double red = std::min(1.0, 2 * bad), green = std::min(1.0, 2 * (1 - bad));
  return {static_cast<uchar>(110), static_cast<uchar>(110 + 130 * green),
          static_cast<uchar>(110 + 140 * red)};
}

/// One plane through the workspace's centre: `right` and `up` are axes of base (0..2).
struct View {
  const robot::RobotModel& robot;
  const robot::DeltaKinematics& kinematics;
  int right;
  int up;
  double span_m;
  Vec3 middle;  // of the panel; across the plane it is the workspace's centre

  double scale() const { return kPanel_px / span_m; }
  Vec3 at(int column, int row) const {
    Vec3 p = middle;
    p[right] += (column + 0.5 - 0.5 * kPanel_px) / scale();
    p[up] -= (row + 0.5 - 0.5 * kPanel_px) / scale();
    return p;
  }
  cv::Point pixel(const Vec3& p) const {
    return {cvRound(0.5 * kPanel_px + (p[right] - middle[right]) * scale()),
            cvRound(0.5 * kPanel_px - (p[up] - middle[up]) * scale())};
  }
};

void draw_conditioning(const View& view, cv::Mat& panel) {
  for (int row = 0; row < panel.rows; ++row) {
    for (int column = 0; column < panel.cols; ++column) {
      const Vec3 p = view.at(column, row);
      const auto joints = view.kinematics.inverse(p);
      if (joints)
        panel.at<cv::Vec3b>(row, column) = colour(view.kinematics.conditioning(*joints, p).condition);
    }
  }
}

/// Lines every 20 or 50 mm, labelled in millimetres.
void draw_grid(const View& view, cv::Mat& panel) {
  const double step = view.span_m > 0.3 ? 0.05 : 0.02;
  const double half = 0.5 * view.span_m;
  for (const int axis : {view.right, view.up}) {
    for (double v = std::ceil((view.middle[axis] - half) / step) * step; v < view.middle[axis] + half;
         v += step) {
      Vec3 p = view.middle;
      p[axis] = v;
      const cv::Point at = view.pixel(p);
      const std::string label = fmt::format("{:.0f}", std::round(1e3 * v) + 0.0);
      if (axis == view.right) {
        cv::line(panel, {at.x, 0}, {at.x, panel.rows}, kGrid);
        text(panel, label, {at.x + 3, panel.rows - 5}, 0.38);
      } else {
        cv::line(panel, {0, at.y}, {panel.cols, at.y}, kGrid);
        text(panel, label, {4, at.y - 3}, 0.38);
      }
    }
  }
}

/// The machine with its tool in the workspace's centre: rails, carriages, rods, tool.
void draw_machine(const View& view, cv::Mat& panel) {
  const Vec3 tool = view.robot.workspace.centre_m;
  const auto joints = view.kinematics.inverse(tool);
  const auto& g = view.robot.geometry;
  for (int leg = 0; joints && leg < 3; ++leg) {
    const double theta = g.rail_angle_rad[static_cast<std::size_t>(leg)];
    const Vec3 tool_joint = tool + g.tool_radius_m * Vec3(std::cos(theta), std::sin(theta), 0);
    const Vec3 carriage = view.kinematics.carriage(leg, (*joints)[leg]);
    cv::line(panel, view.pixel(view.kinematics.carriage(leg, g.stroke_min_m)),
             view.pixel(view.kinematics.carriage(leg, g.stroke_max_m)), kInk, 1, cv::LINE_AA);
    cv::line(panel, view.pixel(carriage), view.pixel(tool_joint), kInk, 2, cv::LINE_AA);
    cv::line(panel, view.pixel(tool), view.pixel(tool_joint), kInk, 2, cv::LINE_AA);
    cv::circle(panel, view.pixel(carriage), 5, kInk, cv::FILLED, cv::LINE_AA);
  }
}

void draw(const View& view, cv::Mat panel, const std::string& title, cv::Mat& picture, cv::Point title_at) {
  draw_conditioning(view, panel);
  draw_grid(view, panel);
  draw_machine(view, panel);
  const robot::Workspace& w = view.robot.workspace;
  if (view.up == 1) {
    cv::circle(panel, view.pixel(w.centre_m), cvRound(w.radius_m * view.scale()), kOutline, 2, cv::LINE_AA);
  } else {
    const Vec3 corner(w.radius_m, 0, 0.5 * w.height_m);
    cv::rectangle(panel, view.pixel(w.centre_m - corner), view.pixel(w.centre_m + corner), kOutline, 2,
                  cv::LINE_AA);
  }
  cv::rectangle(panel, cv::Rect(0, 0, panel.cols, panel.rows), kInk);
  text(picture, title, title_at, 0.5);
}

}  // namespace

void draw_workspace(const robot::RobotModel& robot, const std::filesystem::path& file) {
  const robot::DeltaKinematics kinematics(robot.geometry);
  cv::Mat picture(kHead_px + kPanel_px + kFoot_px, 2 * kPanel_px + 60, CV_8UC3, cv::Scalar::all(255));
  const robot::Workspace& w = robot.workspace;
  const Vec3 half_size(w.radius_m, w.radius_m, 0.5 * w.height_m);
  Vec3 low = w.centre_m - half_size, high = w.centre_m + half_size;
  for (int leg = 0; leg < 3; ++leg) {
    for (const double joint : {robot.geometry.stroke_min_m, robot.geometry.stroke_max_m}) {
      low = low.cwiseMin(kinematics.carriage(leg, joint));
      high = high.cwiseMax(kinematics.carriage(leg, joint));
    }
  }
  const double span = 1.2 * (high - low).maxCoeff();
  const Vec3 middle = 0.5 * (low + high);
  const View above{robot, kinematics, 0, 1, span, {middle.x(), middle.y(), w.centre_m.z()}};
  const View side{robot, kinematics, 0, 2, span, {middle.x(), w.centre_m.y(), middle.z()}};
  const cv::Point left(20, kHead_px), right(40 + kPanel_px, kHead_px), raise(0, -12);
  const cv::Size size(kPanel_px, kPanel_px);
  draw(above, picture({left, size}),
       fmt::format("{}: x, y at z = {:.1f} mm", robot.name, 1e3 * w.centre_m.z()), picture, left + raise);
  draw(side, picture({right, size}), fmt::format("x, z at y = {:.1f} mm", 1e3 * w.centre_m.y()), picture,
       right + raise);
  const int foot = kHead_px + kPanel_px + 38;
  text(picture,
       fmt::format("workspace: radius {:.1f} mm, height {:.1f} mm", 1e3 * robot.workspace.radius_m,
                   1e3 * robot.workspace.height_m),
       {20, foot}, 0.5);
  text(picture, "condition number", {right.x, foot}, 0.5);
  int x = right.x + 160;
  for (const double condition : {1.0, 2.0, 4.0, 8.0}) {
    const cv::Vec3b c = colour(condition);
    cv::rectangle(picture, cv::Rect(x, foot - 12, 28, 14), cv::Scalar(c[0], c[1], c[2]), cv::FILLED);
    text(picture, fmt::format("{:.0f}{}", condition, condition == 8 ? " and worse" : ""), {x + 34, foot},
         0.45);
    x += 70;
  }
  if (!cv::haveImageWriter(file.string())) {
    throw usage_error("--picture " + file.string() + ": no picture has such an extension; use .png");
  }
  reporting::write_picture(file, picture);
}

}  // namespace telekerf::inspect
