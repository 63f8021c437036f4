// SPDX-License-Identifier: Apache-2.0
#include "common/robot/workspace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace telekerf::robot {
namespace {

/// Reachable points on a regular grid; point (0, 0) of the base is on it.
struct Grid {
  Vec3 origin;
  double step_m = 0;
  double step_z_m = 0;
  int nx = 0, ny = 0, nz = 0;
  std::vector<char> free;

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * ny + static_cast<std::size_t>(y)) * nx +
           static_cast<std::size_t>(x);
  }
  Vec3 point(int x, int y, int z) const { return origin + Vec3(x * step_m, y * step_m, z * step_z_m); }
};

template <typename Free>
void fill(Grid& grid, Free free) {
  grid.free.assign(static_cast<std::size_t>(grid.nx) * grid.ny * grid.nz, 0);
  for (int z = 0; z < grid.nz; ++z) {
    for (int y = 0; y < grid.ny; ++y) {
      for (int x = 0; x < grid.nx; ++x) {
        grid.free[grid.index(x, y, z)] = free(grid.point(x, y, z));
      }
    }
  }
}

/// Grid over the box [low, high], with (0, 0) on it.
Grid grid_over(const Vec3& low, const Vec3& high, int cells) {
  Grid grid;
  grid.step_m = std::max(high.x() - low.x(), high.y() - low.y()) / (cells - 1);
  grid.step_z_m = (high.z() - low.z()) / (cells - 1);
  grid.origin = Vec3(std::floor(low.x() / grid.step_m) * grid.step_m,
                     std::floor(low.y() / grid.step_m) * grid.step_m, low.z());
  grid.nx = static_cast<int>(std::ceil((high.x() - grid.origin.x()) / grid.step_m)) + 1;
  grid.ny = static_cast<int>(std::ceil((high.y() - grid.origin.y()) / grid.step_m)) + 1;
  grid.nz = cells;
  return grid;
}

/// Per layer: distance in steps from each point to the nearest one that is not free (outside counts as not
/// free).
std::vector<double> clearance(const Grid& grid) {
  std::vector<double> in_row(grid.free.size());
  std::vector<double> result(grid.free.size());
  for (int z = 0; z < grid.nz; ++z) {
    for (int y = 0; y < grid.ny; ++y) {
      double run = 0;
      for (int x = 0; x < grid.nx; ++x) {
        run = grid.free[grid.index(x, y, z)] ? run + 1 : 0;
        in_row[grid.index(x, y, z)] = run;
      }
      run = 0;
      for (int x = grid.nx - 1; x >= 0; --x) {
        run = grid.free[grid.index(x, y, z)] ? run + 1 : 0;
        in_row[grid.index(x, y, z)] = std::min(run, in_row[grid.index(x, y, z)]);
      }
    }
    for (int y = 0; y < grid.ny; ++y) {
      for (int x = 0; x < grid.nx; ++x) {
        const double border = std::min(y, grid.ny - 1 - y) + 1;
        double nearest2 = border * border;
        for (int other = 0; other < grid.ny; ++other) {
          const double row = in_row[grid.index(x, other, z)];
          nearest2 = std::min(nearest2, row * row + (other - y) * (other - y));
        }
        result[grid.index(x, y, z)] = std::sqrt(nearest2);
      }
    }
  }
  return result;
}

struct Candidate {
  double volume = 0;
  Workspace workspace;
};

/// Best cylinder about the column (x, y).
Candidate best_on(const Grid& grid, const std::vector<double>& clear, int x, int y) {
  Candidate best;
  for (int bottom = 0; bottom < grid.nz; ++bottom) {
    double radius = std::numeric_limits<double>::infinity();
    for (int top = bottom; top < grid.nz; ++top) {
      radius = std::min(radius, (clear[grid.index(x, y, top)] - 1) * grid.step_m);
      if (radius <= 0) break;
      const double height = (top - bottom) * grid.step_z_m;
      if (radius * radius * height > best.volume) {
        best.volume = radius * radius * height;
        best.workspace = {0.5 * (grid.point(x, y, bottom) + grid.point(x, y, top)), radius, height};
      }
    }
  }
  return best;
}

/// Calls `visit` on samples of the cylinder: rings on several heights, its axis included. Stops when it says
/// false.
template <typename Visit>
bool over_cylinder(const Workspace& w, int rings, Visit visit) {
  constexpr int kAngles = 72;
  constexpr int kLayers = 11;
  for (int layer = 0; layer < kLayers; ++layer) {
    const double z = w.height_m * (static_cast<double>(layer) / (kLayers - 1) - 0.5);
    for (int ring = 0; ring < rings; ++ring) {
      const double r = w.radius_m * (1.0 - static_cast<double>(ring) / rings);
      for (int step = 0; step < kAngles; ++step) {
        const double angle = 2 * std::numbers::pi * step / kAngles;
        if (!visit(Vec3(w.centre_m + Vec3(r * std::cos(angle), r * std::sin(angle), z)))) return false;
      }
    }
    if (!visit(Vec3(w.centre_m + Vec3(0, 0, z)))) return false;
  }
  return true;
}

}  // namespace

bool workable(const DeltaKinematics& kinematics, const Vec3& tool_m, double worst_condition) noexcept {
  const auto joints = kinematics.inverse(tool_m);
  return joints && kinematics.conditioning(*joints, tool_m).condition <= worst_condition;
}

Workspace largest_cylinder(const DeltaKinematics& kinematics, double worst_condition, int cells) {
  // A coarse look over everything that the rods could reach gives the box; the fine grid covers the box.
  const auto& g = kinematics.geometry();
  const double rod = *std::max_element(g.rod_length_m.begin(), g.rod_length_m.end());
  const double stroke = std::max(std::abs(g.stroke_min_m), std::abs(g.stroke_max_m));
  const double side = std::abs(g.base_radius_m - g.tool_radius_m) + stroke + rod;
  Grid coarse = grid_over(Vec3::Constant(-side), Vec3::Constant(side), cells);
  fill(coarse, [&](const Vec3& p) { return kinematics.inverse(p).has_value(); });
  Vec3 low = Vec3::Constant(side);
  Vec3 high = -low;
  for (int z = 0; z < coarse.nz; ++z) {
    for (int y = 0; y < coarse.ny; ++y) {
      for (int x = 0; x < coarse.nx; ++x) {
        if (!coarse.free[coarse.index(x, y, z)]) continue;
        low = low.cwiseMin(coarse.point(x, y, z));
        high = high.cwiseMax(coarse.point(x, y, z));
      }
    }
  }
  if (low.x() > high.x()) return {};
  const Vec3 margin(coarse.step_m, coarse.step_m, coarse.step_z_m);
  Grid grid = grid_over(low - margin, high + margin, cells);
  fill(grid, [&](const Vec3& p) { return workable(kinematics, p, worst_condition); });

  const std::vector<double> clear = clearance(grid);
  Candidate best;
  Candidate on_axis;
  for (int y = 0; y < grid.ny; ++y) {
    for (int x = 0; x < grid.nx; ++x) {
      const Candidate here = best_on(grid, clear, x, y);
      if (here.volume > best.volume) best = here;
      const Vec3 column = grid.point(x, y, 0);
      if (std::hypot(column.x(), column.y()) < 0.5 * grid.step_m) on_axis = here;
    }
  }
  constexpr double kClearlyBetter = 1.1;
  if (on_axis.volume * kClearlyBetter >= best.volume) {
    best = on_axis;
    best.workspace.centre_m.x() = best.workspace.centre_m.y() = 0;
  }

  // The grid only proposes; in steps of 0.1 mm, the radius is what the surface allows.
  constexpr double kStepsPerMetre = 1e4;
  Workspace found = best.workspace;
  for (auto* value : {&found.centre_m.x(), &found.centre_m.y(), &found.centre_m.z()}) {
    *value = std::round(*value * kStepsPerMetre) / kStepsPerMetre;
  }
  found.height_m = std::floor(found.height_m * kStepsPerMetre) / kStepsPerMetre;
  const auto fits = [&](int steps) {
    found.radius_m = steps / kStepsPerMetre;
    return over_cylinder(found, 1, [&](const Vec3& p) { return workable(kinematics, p, worst_condition); });
  };
  int steps = static_cast<int>(best.workspace.radius_m * kStepsPerMetre);
  const int most = static_cast<int>((best.workspace.radius_m + 2 * grid.step_m) * kStepsPerMetre);
  while (steps < most && fits(steps + 1)) ++steps;
  while (steps > 0 && !fits(steps)) --steps;
  found.radius_m = steps / kStepsPerMetre;
  return found;
}

double worst_condition(const DeltaKinematics& kinematics, const Workspace& workspace) {
  double worst = 0;
  over_cylinder(workspace, 5, [&](const Vec3& p) {
    const auto joints = kinematics.inverse(p);
    worst = std::max(worst, joints ? kinematics.conditioning(*joints, p).condition
                                   : std::numeric_limits<double>::infinity());
    return true;
  });
  return worst;
}

}  // namespace telekerf::robot
