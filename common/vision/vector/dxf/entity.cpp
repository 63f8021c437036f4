// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/entity.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

void absorb(std::vector<DxfVertex>& vertices, int code, double value) {
  if (code == 10) vertices.push_back({Vec2(value, 0.0), 0.0});
  if (vertices.empty()) return;
  if (code == 20) vertices.back().at.y() = value;
  if (code == 42) vertices.back().bulge = value;
}

void absorb(Spline& spline, int code, double value) {
  if (code == 71) spline.degree = static_cast<int>(std::clamp(value, 0.0, 100.0));
  if (code == 40) spline.knots.push_back(value);
  if (code == 41) spline.weights.push_back(value);
  if (code == 10) spline.control.emplace_back(value, 0.0);
  if (code == 20 && !spline.control.empty()) spline.control.back().y() = value;
}

void absorb(DxfInsert& insert, int code, double value) {
  if (code == 10) insert.at.x() = value;
  if (code == 20) insert.at.y() = value;
  if (code == 41) insert.scale.x() = value;
  if (code == 42) insert.scale.y() = value;
  if (code == 50) insert.angle_deg = value;
  if (code == 44) insert.spacing.x() = value;
  if (code == 45) insert.spacing.y() = value;
  if (code == 70) insert.columns = static_cast<int>(std::clamp(value, 1.0, 1e6));
  if (code == 71) insert.rows = static_cast<int>(std::clamp(value, 1.0, 1e6));
}

}  // namespace

bool absorb(DxfEntity& e, const DxfGroup& g) {
  if (g.code == 2 && e.kind == "INSERT") e.insert.block = g.value;
  if (g.code == 8) e.layer = g.value;
  if (g.code == 6) e.line_type = g.value;
  const bool wanted = (g.code >= 10 && g.code <= 60) || g.code == 62 || g.code == 67 || g.code == 70 ||
                      g.code == 71 || (g.code >= 210 && g.code <= 230) || g.code == 420;
  if (!wanted) return true;
  std::string_view text = g.value;
  const auto value = take_number(text);
  if (!value || !text.empty()) return false;
  if (g.code < 60) e.given.set(static_cast<std::size_t>(g.code));
  if (g.code < 60) e.number[g.code] = *value;
  if (g.code == 30 || g.code == 31) {
    e.lowest_z = std::min(e.lowest_z, *value);
    e.highest_z = std::max(e.highest_z, *value);
  }
  if (g.code == 60) e.invisible = *value != 0.0;
  if (g.code == 62) e.colour = static_cast<int>(std::clamp(*value, -256.0, 257.0));
  if (g.code == 420) e.true_colour = std::lround(std::clamp(*value, 0.0, 16777215.0));
  if (g.code == 67) e.on_sheet = *value != 0.0;
  if (g.code == 70) e.flags = static_cast<int>(std::clamp(*value, -32768.0, 65535.0));
  if (g.code == 210 || g.code == 220) e.tilted = e.tilted || std::abs(*value) > 1e-9;
  if (g.code == 230) e.extruded_down = *value < 0.0;
  if (e.kind == "LWPOLYLINE") absorb(e.vertices, g.code, *value);
  if (e.kind == "SPLINE") absorb(e.spline, g.code, *value);
  if (e.kind == "SPLINE" && g.code == 11) e.fit_points.emplace_back(*value, 0.0);
  if (e.kind == "SPLINE" && g.code == 21 && !e.fit_points.empty()) e.fit_points.back().y() = *value;
  if (e.kind == "INSERT") absorb(e.insert, g.code, *value);
  return true;
}

bool draws_nothing(const DxfEntity& e) {
  return e.kind == "VIEWPORT" || e.kind == "SEQEND" || e.kind == "ATTDEF";
}

}  // namespace telekerf::vision
