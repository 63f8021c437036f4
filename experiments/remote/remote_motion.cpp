// SPDX-License-Identifier: Apache-2.0
#include "experiments/remote/remote_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/nearest.h"
#include "common/reporting/run_lookup.h"
#include "common/runtime/startup_error.h"
#include "slave/laser/pulsed_beam.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;
using reporting::in_plane;

geometry::Polyline contour_of(const RunRecord& record) {
  if (record.contour_m.size() < 2) throw input_error("the run has no contour: nothing was machined");
  return {record.contour_m, record.contour_closed};
}

/// Figures have every tenth row; speeds are differences over twice that.
constexpr std::size_t kStep = 10;
constexpr double kBin_m = 0.25e-3;

ordered_json speeds_mm_s(const std::vector<RemoteSample>& motion, double RemoteSample::*speed) {
  double sum = 0.0, squares = 0.0, low = INFINITY, high = -INFINITY;
  for (const RemoteSample& sample : motion) {
    const double v = 1e3 * sample.*speed;
    sum += v;
    squares += v * v;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double n = static_cast<double>(motion.size());
  const double mean = sum / n;
  return {{"mean", mean},
          {"deviation", std::sqrt(std::max(0.0, squares / n - mean * mean))},
          {"min", low},
          {"max", high}};
}

}  // namespace

namespace {

/// Every `every`-th row, beginning with the tenth.
std::vector<RemoteSample> motion_at(const RunRecord& record, std::size_t every) {
  const geometry::NearestIndex contour(contour_of(record));
  const auto& rows = record.slave;
  std::vector<RemoteSample> out;
  std::optional<geometry::Nearest> place;
  const auto master = [&](const SlaveRow& row) {
    return row.applied < 0.0 ? std::optional<Vec3>()
                             : reporting::master_at(record, row.applied, &MasterRow::tool_m);
  };
  for (std::size_t i = kStep; i + kStep < rows.size(); i += every) {
    const SlaveRow &row = rows[i], &before = rows[i - kStep], &after = rows[i + kStep];
    const auto now = master(row), early = master(before), late = master(after);
    if (!now || !early || !late || !reporting::joined_at(record, before.applied)) {
      place.reset();
      continue;
    }
    RemoteSample sample;
    const double beta = reporting::beta_at(record, row.applied);
    sample.time_s = row.t_s - rows.front().t_s;
    sample.master_m = in_plane(*now);
    sample.slave_m = in_plane(row.tool_m);
    sample.rescaled_m = sample.slave_m / beta;
    sample.beam = row.laser_w > 0.0;
    // At a crossing it stays on the branch it came along.
    place = place ? contour.find_near(sample.slave_m, place->segment) : contour.find(sample.slave_m);
    const double dt_s = after.t_s - before.t_s;
    sample.slave_m_per_s = in_plane(after.tool_m - before.tool_m).dot(place->tangent) / dt_s;
    sample.rescaled_m_per_s = sample.slave_m_per_s / beta;
    sample.master_m_per_s = in_plane(*late - *early).dot(place->tangent) / dt_s;
    out.push_back(sample);
  }
  return out;
}

}  // namespace

std::vector<RemoteSample> remote_motion(const RunRecord& record) { return motion_at(record, kStep); }

std::string motion_csv(const RunRecord& record) {
  std::string text =
      "time_s,master_x_m,master_y_m,slave_x_m,slave_y_m,rescaled_x_m,rescaled_y_m,master_m_per_s,slave_m_per_"
      "s,"
      "rescaled_m_per_s,beam\n";
  for (const RemoteSample& at : motion_at(record, 1))
    text += fmt::format("{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.5g},{:.5g},{:.5g},{}\n",
                        at.time_s, at.master_m.x(), at.master_m.y(), at.slave_m.x(), at.slave_m.y(),
                        at.rescaled_m.x(), at.rescaled_m.y(), at.master_m_per_s, at.slave_m_per_s,
                        at.rescaled_m_per_s, at.beam ? 1 : 0);
  return text;
}

ordered_json speed_json(const std::vector<RemoteSample>& motion) {
  if (motion.empty()) return nullptr;
  double squares = 0.0, most = 0.0;
  for (const RemoteSample& sample : motion) {
    const double apart = sample.rescaled_m_per_s - sample.master_m_per_s;
    squares += apart * apart;
    most = std::max(most, std::abs(apart));
  }
  return {{"master_mm_s", speeds_mm_s(motion, &RemoteSample::master_m_per_s)},
          {"slave_mm_s", speeds_mm_s(motion, &RemoteSample::slave_m_per_s)},
          {"rescaled_minus_master_mm_s",
           {{"rms", 1e3 * std::sqrt(squares / static_cast<double>(motion.size()))}, {"max", 1e3 * most}}}};
}

ordered_json measured_beta(const std::vector<RemoteSample>& motion) {
  Vec2 master_sum = Vec2::Zero(), slave_sum = Vec2::Zero();
  for (const RemoteSample& sample : motion) {
    master_sum += sample.master_m;
    slave_sum += sample.slave_m;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, motion.size()));
  double both = 0.0, squares = 0.0;
  for (const RemoteSample& sample : motion) {
    const Vec2 master = sample.master_m - master_sum / n;
    both += master.dot(sample.slave_m - slave_sum / n);
    squares += master.squaredNorm();
  }
  return squares > 0.0 ? ordered_json(both / squares) : ordered_json();
}

ordered_json button_json(const RunRecord& record) {
  std::size_t lit = 0, without = 0, held = 0;
  for (const MasterRow& row : record.master) held += row.button ? 1 : 0;
  for (const SlaveRow& row : record.slave) {
    if (row.laser_w <= 0.0) continue;
    ++lit;
    const double place =
        record.master.empty() ? -1.0 : row.applied - static_cast<double>(record.master.front().tick);
    const bool pressed = place >= 0.0 && place < static_cast<double>(record.master.size()) &&
                         record.master[static_cast<std::size_t>(place)].button;
    without += pressed ? 0 : 1;
  }
  const double ticks = static_cast<double>(std::max<std::size_t>(1, record.master.size()));
  return {{"beam_ticks", lit},
          {"beam_ticks_without_button", without},
          {"button_share", static_cast<double>(held) / ticks}};
}

RemoteMark burn_record(const RunRecord& record, const workpiece::Material& material, BeamPower power,
                       double laser_w) {
  const geometry::Polyline line = contour_of(record);
  const geometry::NearestIndex contour(line);
  const geometry::Box box = geometry::bounding_box(line.points_m);
  constexpr double kPixel_m = 15e-6, kMargin_m = 1e-3;
  const double half_width_m = 0.5 * box.size().maxCoeff() + kMargin_m;
  RemoteMark mark{{},
                  workpiece::Workpiece({.centre_m = box.centre(),
                                        .half_width_m = half_width_m,
                                        .pixels = workpiece::pixels_for(half_width_m, kPixel_m)},
                                       material)};
  const auto bins = static_cast<std::size_t>(std::ceil(contour.length_m() / kBin_m));
  const double bin_m = contour.length_m() / static_cast<double>(bins);
  mark.dwell_s_per_m.assign(bins, 0.0);
  laser::PulsedBeam beam({}, mark.workpiece);
  for (std::size_t i = 0; i + 1 < record.slave.size(); ++i) {
    const SlaveRow &row = record.slave[i], &next = record.slave[i + 1];
    if (row.laser_w <= 0.0) continue;
    const double dt_s = next.t_s - row.t_s;
    beam.expose(in_plane(row.tool_m), in_plane(next.tool_m),
                power == BeamPower::kConstant ? laser_w : row.laser_w, dt_s);
    const double arc_m = contour.find(in_plane(row.tool_m)).arc_length_m;
    mark.dwell_s_per_m[std::min(bins - 1, static_cast<std::size_t>(arc_m / bin_m))] += dt_s / bin_m;
  }
  for (std::size_t b = 0; b < bins; ++b) {
    constexpr int kPlaces = 10;
    double sum_m = 0.0;
    for (int k = 0; k < kPlaces; ++k)
      sum_m +=
          mark.workpiece.depth_m(contour.at((static_cast<double>(b) + (k + 0.5) / kPlaces) * bin_m).point_m);
    mark.arc_m.push_back((static_cast<double>(b) + 0.5) * bin_m);
    mark.depth_m.push_back(sum_m / kPlaces);
  }
  return mark;
}

ordered_json mark_json(const RemoteMark& mark) {
  double n = 0.0, sum = 0.0, squares = 0.0, deepest = 0.0, dwell = 0.0, dwell_squares = 0.0, both = 0.0,
         stray = 0.0;
  double through = 0.0;
  const std::size_t bins = mark.depth_m.size();
  for (std::size_t i = 0; i < bins; ++i) {
    const double depth = mark.depth_m[i], stayed = mark.dwell_s_per_m[i];
    const auto dark = [&](std::size_t b) { return mark.dwell_s_per_m[b] == 0.0; };
    // A beam at the bin's end reaches into its neighbour.
    if (dark(i) && dark((i + 1) % bins) && dark((i + bins - 1) % bins)) stray = std::max(stray, depth);
    // The ends of a stretch are only partly lit.
    if (dark(i) || dark((i + 1) % bins) || dark((i + bins - 1) % bins)) continue;
    n += 1.0;
    sum += depth;
    squares += depth * depth;
    deepest = std::max(deepest, depth);
    through += depth >= 0.99 * mark.workpiece.material().thickness_m ? 1.0 : 0.0;
    dwell += stayed;
    dwell_squares += stayed * stayed;
    both += stayed * depth;
  }
  if (n < 2.0) return nullptr;
  const double spread = std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
  const double dwell_spread = std::sqrt(std::max(0.0, dwell_squares / n - dwell / n * (dwell / n)));
  const double together = both / n - sum / n * (dwell / n);
  const bool varies = spread > 0.0 && dwell_spread > 0.0;
  return {
      {"marked_share", n / static_cast<double>(bins)},
      {"mean_mm", 1e3 * sum / n},
      {"max_mm", 1e3 * deepest},
      {"variation", spread / (sum / n)},
      {"cut_through_share", through / n},
      {"correlation_with_dwell", varies ? ordered_json(together / (spread * dwell_spread)) : ordered_json()},
      {"unlit_max_mm", 1e3 * stray}};
}

}  // namespace telekerf::experiments
