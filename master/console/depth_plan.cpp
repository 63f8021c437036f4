// SPDX-License-Identifier: Apache-2.0
#include "master/console/depth_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/workpiece/line_depth.h"

namespace telekerf::master {

DepthPlan::DepthPlan(const CutPower& cut, const workpiece::Material& material, double depth_m)
    : cut_(cut),
      material_(&material),
      depth_m_(depth_m),
      pass_m_(workpiece::depth_speed_m2_per_s(material, cut.laser_w) / cut.power.speed_m_per_s) {}

std::optional<double> DepthPlan::speed_m_per_s() const noexcept {
  if (!(depth_m_ > 0.0) || depth_m_ > pass_m_) return std::nullopt;
  return full_speed_m_per_s() * pass_m_ / depth_m_;
}

std::string DepthPlan::sentence() const {
  const double full_mm_s = 1e3 * full_speed_m_per_s();
  const std::string pass = fmt::format("{} gets {:.2f} mm a pass at up to {:.0f} mm/s", material_->name,
                                       1e3 * std::min(pass_m_, material_->thickness_m), full_mm_s);
  if (!(depth_m_ > 0.0)) return pass;
  if (!(pass_m_ > 0.0)) return fmt::format("These pulses remove nothing of {}", material_->name);
  if (depth_m_ >= material_->thickness_m) {
    return fmt::format("{}; {:.2f} mm is all of its {:.2f} mm: {:.0f} passes", pass, 1e3 * depth_m_,
                       1e3 * material_->thickness_m, std::ceil(material_->thickness_m / pass_m_));
  }
  if (const auto speed = speed_m_per_s())
    return fmt::format("{}; move at {:.0f} mm/s on the workpiece for {:.2f} mm", pass, 1e3 * *speed,
                       1e3 * depth_m_);
  return fmt::format("{}; {:.2f} mm takes {:.1f} passes, or one with --laser-speed-mm-s {:.1f} at the slave",
                     pass, 1e3 * depth_m_, depth_m_ / pass_m_,
                     1e3 * cut_.power.speed_m_per_s * pass_m_ / depth_m_);
}

void DepthTrail::begin(const geometry::Polyline& contour) {
  line_ = contour.points_m.empty() ? nullptr : std::make_unique<geometry::NearestIndex>(contour);
  const double length_m = line_ ? line_->length_m() : 0.0;
  const double pieces = std::clamp(std::ceil(length_m / kPiece_m), 0.0, static_cast<double>(kMostPieces));
  lit_s_.assign(static_cast<std::size_t>(pieces), 0.0);
  piece_m_ = pieces > 0.0 ? length_m / pieces : kPiece_m;
  ++version_;
}

void DepthTrail::burn(const Vec2& place_m, double speed_m_per_s, double dt_s) noexcept {
  if (lit_s_.empty()) return;
  const geometry::Nearest at = line_->find(place_m);
  if (!(at.distance_m < kFarthest_m)) return;
  const auto piece = std::min(static_cast<std::size_t>(at.arc_length_m / piece_m_), lit_s_.size() - 1);
  lit_s_[piece] += dt_s * workpiece::power_fraction(power_, speed_m_per_s);
  ++version_;
}

void DepthTrail::add(const std::vector<double>& lit_s) noexcept {
  if (lit_s.size() != lit_s_.size()) return;
  for (std::size_t n = 0; n < lit_s.size(); ++n) lit_s_[n] += lit_s[n];
  ++version_;
}

std::vector<float> DepthTrail::depths_m(const CutPower& cut, const workpiece::Material& material) const {
  const double m_per_s = workpiece::depth_speed_m2_per_s(material, cut.laser_w) / piece_m_;
  std::vector<float> depths;
  depths.reserve(lit_s_.size());
  for (const double lit_s : lit_s_)
    depths.push_back(static_cast<float>(std::min(m_per_s * lit_s, material.thickness_m)));
  return depths;
}

}  // namespace telekerf::master
