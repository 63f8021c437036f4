// SPDX-License-Identifier: Apache-2.0
#include "tools/plant/light_book.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/corridor.h"

namespace telekerf::plant {

LightBook::LightBook(double radius_m)
    : side_(2 * (static_cast<int>(std::ceil(radius_m / kCell_m)) + kReach + 1)),
      dose_j_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.0F) {
  lights_.reserve(kMostLights);
}

void LightBook::add(std::int64_t from_ns, std::int64_t to_ns, const Vec2& at_m, double power_w,
                    const geometry::NearestIndex* contour) {
  if (!(power_w > 0.0) || to_ns <= from_ns) return;
  const double energy_j = power_w * 1e-9 * static_cast<double>(to_ns - from_ns);
  const bool inside = contour != nullptr && contour->find(at_m).distance_m <= geometry::kCorridorHalfWidth_m;
  (inside ? inside_j_ : outside_j_) += energy_j;
  deposit(at_m, energy_j);
  if (!lit_) {
    lit_ = true;
    kept_ = lights_.size() < kMostLights;
    if (kept_) {
      lights_.push_back({.from_ns = from_ns});
    } else {
      ++unkept_;
    }
  }
  if (!kept_) return;
  lights_.back().to_ns = to_ns;
  lights_.back().energy_j += energy_j;
}

void LightBook::dark(DarkBy by, std::int64_t after_ns) noexcept {
  if (!lit_) return;
  lit_ = false;
  if (kept_) lights_.back().by = by;
  if (by == DarkBy::kTold) return;
  ++by_itself_;
  dark_after_ns_ = std::max(dark_after_ns_, after_ns);
}

void LightBook::deposit(const Vec2& at_m, double energy_j) {
  const auto cell = [&](double m) {
    return std::clamp(static_cast<int>(std::floor(m / kCell_m)) + side_ / 2, kReach, side_ - 1 - kReach);
  };
  const int column = cell(at_m.x()), row = cell(at_m.y());
  for (int r = -kReach; r <= kReach; ++r) {
    for (int c = -kReach; c <= kReach; ++c) {
      if (r * r + c * c > kReach * kReach) continue;
      float& around = dose_j_[static_cast<std::size_t>(row + r) * static_cast<std::size_t>(side_) +
                              static_cast<std::size_t>(column + c)];
      around += static_cast<float>(energy_j);
      dose_j_max_ = std::max(dose_j_max_, static_cast<double>(around));
    }
  }
}

nlohmann::ordered_json LightBook::report() const {
  const auto seconds = [](std::int64_t ns) { return 1e-9 * static_cast<double>(ns); };
  double lit_s = 0.0;
  auto lights = nlohmann::ordered_json::array();
  for (const Light& light : lights_) {
    lit_s += seconds(light.to_ns - light.from_ns);
    lights.push_back({{"from_s", seconds(light.from_ns)},
                      {"to_s", seconds(light.to_ns)},
                      {"energy_j", light.energy_j},
                      {"dark_by", light.by == DarkBy::kTold ? "told" : "itself"}});
  }
  return {{"energy_inside_j", inside_j_}, {"energy_outside_corridor_j", outside_j_},
          {"dose_j_max", dose_j_max_},    {"lit_s", lit_s},
          {"dark_by_itself", by_itself_}, {"dark_after_s_max", dark_after_s()},
          {"lights_unkept", unkept_},     {"lights", lights}};
}

}  // namespace telekerf::plant
