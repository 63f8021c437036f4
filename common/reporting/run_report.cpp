// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/geometry/nearest.h"
#include "common/runtime/error_statistics.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"
#include "slave/laser/mark_picture.h"
#include "slave/laser/workpiece.h"

namespace telekerf::inspect {
namespace {

using geometry::Polyline;

nlohmann::ordered_json um(const ErrorStatistics& spread, const char* rms_um = "rms_um") {
  if (spread.count == 0) return {{rms_um, nullptr}, {"max_um", nullptr}, {"samples", 0}};
  return {{rms_um, spread.rms() * 1e6}, {"max_um", spread.max * 1e6}, {"samples", spread.count}};
}

Vec2 plane(const Triple& point) { return {point[0], point[1]}; }

Polyline contour_of(const RunRecord& record) {
  Polyline line;
  line.closed = record.contour_closed;
  for (const auto& point : record.contour_m) line.points_m.emplace_back(point[0], point[1]);
  return line;
}

double figure(const Metrics& figures, const std::string& name, double fallback = 0.0) {
  const auto found = figures.find(name);
  return found == figures.end() ? fallback : found->second;
}

/// The sum of figures; null if one of them was never measured.
nlohmann::ordered_json known(std::initializer_list<std::pair<const Metrics*, const char*>> parts) {
  double sum = 0.0;
  for (const auto& [figures, name] : parts) {
    if (!figures->contains(name)) return nullptr;
    sum += figures->at(name);
  }
  return sum;
}

std::string word(const RunRecord& record, const std::string& name) {
  const auto found = record.words.find(name);
  return found == record.words.end() ? "" : found->second;
}

/// One of the master's positions at a tick that may lie between two of its rows.
std::optional<Vec3> master_at(const RunRecord& record, double tick, Triple MasterRow::*position) {
  if (record.master.empty()) return std::nullopt;
  const double place = tick - static_cast<double>(record.master.front().tick);
  if (!(place >= 0.0) || place > static_cast<double>(record.master.size() - 1)) return std::nullopt;
  const auto index = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(index);
  const auto& a = record.master[index].*position;
  const auto& b = record.master[std::min(index + 1, record.master.size() - 1)].*position;
  return Vec3(a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2]));
}

/// The force that reached the master, and how far it was off what the slave estimated at the same tick.
nlohmann::ordered_json force_json(const RunRecord& record) {
  ErrorStatistics force;
  ErrorStatistics coding;
  std::size_t samples = 0;
  for (const MasterRow& row : record.master) {
    if (row.force_tick < 0.0 || record.slave.empty()) continue;
    const double place = row.force_tick - static_cast<double>(record.slave.front().tick);
    if (!(place >= 0.0) || place > static_cast<double>(record.slave.size() - 1)) continue;
    const Triple& sent = record.slave[static_cast<std::size_t>(place)].force_n;
    for (std::size_t i = 0; i < 3; ++i) {
      force.add(row.slave_force_n[i]);
      coding.add(row.slave_force_n[i] - sent[i]);
    }
    ++samples;
  }
  if (samples == 0) return {{"rms_n", nullptr}, {"max_n", nullptr}, {"samples", 0}};
  return {{"rms_n", force.rms()},
          {"max_n", force.max},
          {"coding_rms_n", coding.rms()},
          {"coding_max_n", coding.max},
          {"bits_per_sample", figure(record.slave_figures, "force_bits_per_sample")},
          {"samples", samples}};
}

/// Whether the slave had been brought to the master's motion by that tick.
bool joined_at(const RunRecord& record, double tick) {
  if (!master_at(record, tick, &MasterRow::tool_m)) return false;
  return record.master[static_cast<std::size_t>(tick - static_cast<double>(record.master.front().tick))]
      .joined;
}

/// Slave motion = beta x master motion at that tick, which the record holds.
double beta_at(const RunRecord& record, double tick) {
  return record.master[static_cast<std::size_t>(tick - static_cast<double>(record.master.front().tick))].beta;
}

/// Which stretches of the contour the laser reached, in bins of arc length.
class Coverage {
 public:
  explicit Coverage(const geometry::NearestIndex& contour)
      : contour_(contour),
        bins_(std::max<std::size_t>(100, static_cast<std::size_t>(contour.length_m() / 50e-6))) {}

  void mark(const geometry::Nearest& from, const geometry::Nearest& to) {
    const double length = contour_.length_m();
    double step = to.arc_length_m - from.arc_length_m;
    if (contour_.line().closed) step -= length * std::round(step / length);
    if (std::abs(step) > 1e-3) step = 0.0;  // a jump to another branch reaches nothing in between
    const int pieces =
        1 + static_cast<int>(std::abs(step) / length * static_cast<double>(bins_.size()) * 2.0);
    for (int i = 0; i <= pieces; ++i) {
      double arc = from.arc_length_m + step * i / pieces;
      arc -= length * std::floor(arc / length);
      bins_[std::min(bins_.size() - 1,
                     static_cast<std::size_t>(arc / length * static_cast<double>(bins_.size())))] = true;
    }
  }
  double share() const {
    return static_cast<double>(std::count(bins_.begin(), bins_.end(), true)) /
           static_cast<double>(bins_.size());
  }

 private:
  const geometry::NearestIndex& contour_;
  std::vector<bool> bins_;
};

nlohmann::ordered_json loop_json(const Metrics& figures) {
  return {{"rate_hz", figure(figures, "rate_hz")},
          {"slack_us", {{"p50", figure(figures, "slack_p50_us")}, {"p99", figure(figures, "slack_p99_us")}}},
          {"overruns", static_cast<std::int64_t>(figure(figures, "overruns"))},
          {"readings_missed", static_cast<std::int64_t>(figure(figures, "readings_missed"))}};
}

double tick_s(const std::vector<SlaveRow>& rows) {
  return rows.size() < 2 ? 0.0 : (rows.back().t_s - rows.front().t_s) / static_cast<double>(rows.size() - 1);
}

}  // namespace

nlohmann::ordered_json make_report(const RunRecord& record) {
  if (record.contour_m.size() < 2) throw StartupError("the run has no contour: nothing to report");
  const geometry::NearestIndex contour(contour_of(record));
  const double dt_s = figure(record.slave_figures, "control_period_s", tick_s(record.slave));

  ErrorStatistics constraint;
  for (const auto& row : record.master) {
    // In the master's size: to contour / beta.
    if (row.guided) constraint.add(contour.find(row.beta * plane(row.tool_m)).distance_m / row.beta);
  }

  ErrorStatistics tracking;
  ErrorStatistics prediction;
  ErrorStatistics cut;
  Coverage coverage(contour);
  double laser_on_s = 0.0;
  double inside_j = 0.0;
  double outside_j = 0.0;
  std::optional<geometry::Nearest> previous;
  for (const auto& row : record.slave) {
    if (row.settled && row.applied >= 0.0 && joined_at(record, row.applied)) {
      const Vec3 tool(row.tool_m[0], row.tool_m[1], row.tool_m[2]);
      const Vec3 master = *master_at(record, row.applied, &MasterRow::tool_m);
      tracking.add((tool - beta_at(record, row.applied) * master).norm());
      prediction.add((tool - *master_at(record, row.applied, &MasterRow::predicted_m)).norm());
    }
    if (row.laser_w <= 0.0) {
      previous.reset();
      continue;
    }
    const geometry::Nearest nearest = contour.find(plane(row.tool_m));
    cut.add(nearest.distance_m);
    laser_on_s += dt_s;
    (nearest.distance_m <= kCorridorM ? inside_j : outside_j) += row.laser_w * dt_s;
    if (nearest.distance_m <= kCorridorM) {
      coverage.mark(previous.value_or(nearest), nearest);
      previous = nearest;
    } else {
      previous.reset();
    }
  }

  nlohmann::ordered_json cut_json = um(cut);
  cut_json["coverage"] = coverage.share();
  cut_json["laser_on_s"] = laser_on_s;
  cut_json["energy_inside_j"] = inside_j;
  cut_json["energy_outside_corridor_j"] = outside_j;

  const Metrics& m = record.master_figures;
  const Metrics& s = record.slave_figures;
  nlohmann::ordered_json report;
  report["contour"] = {{"points", record.contour_m.size()},
                       {"length_m", contour.length_m()},
                       {"closed", record.contour_closed},
                       {"image", word(record, "image")},
                       {"mode", word(record, "mode")}};
  report["beta"] = figure(record.master_figures, "beta", 1.0);
  report["law"] = word(record, "law");
  report["estimator"] = word(record, "estimator");
  report["drive"] = {{"master", words_of(record.master_drive)}, {"slave", words_of(record.slave_drive)}};
  report["constraint"] = um(constraint);
  report["tracking"] = um(tracking);
  report["prediction"] = um(prediction, "rmse_um");
  report["cut"] = cut_json;
  report["link"] = {{"rtt_ms",
                     {{"p50", known({{&m, "rtt_p50_ms"}})},
                      {"p95", known({{&m, "rtt_p95_ms"}})},
                      {"p99", known({{&m, "rtt_p99_ms"}})}}},
                    {"block_ms", figure(m, "block_ms")},
                    {"playout_ms", figure(s, "playout_ms")},
                    {"total_ms", known({{&m, "rtt_p50_ms"}, {&m, "block_ms"}, {&s, "playout_ms"}})},
                    {"lost", static_cast<std::int64_t>(figure(s, "lost") + figure(m, "lost"))},
                    {"refused", static_cast<std::int64_t>(figure(s, "refused") + figure(m, "refused"))},
                    {"payload_bytes_per_s", figure(m, "payload_bytes_per_s")},
                    {"wire_bytes_per_s", figure(m, "wire_bytes_per_s")},
                    {"packets_per_s", figure(m, "packets_per_s")}};
  report["codec"] = {{"name", word(record, "codec")},
                     {"block", static_cast<std::int64_t>(figure(m, "block"))},
                     {"kept", static_cast<std::int64_t>(figure(m, "keep"))},
                     {"max_rms", figure(m, "max_rms")},
                     {"redundancy", static_cast<std::int64_t>(figure(m, "redundancy"))},
                     {"bits_per_sample", figure(m, "bits_per_sample")}};
  report["force"] = force_json(record);
  report["loop"] = {{"master", loop_json(m)}, {"slave", loop_json(s)}};
  report["seed"] = static_cast<std::int64_t>(figure(m, "seed"));
  report["netem"] = word(record, "netem");
  report["version"] = kVersion;
  return report;
}

namespace {

void write_trace(const std::filesystem::path& file, const RunRecord& record) {
  std::string out =
      "t_s,master_x_m,master_y_m,master_z_m,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w,"
      "force_x_n,force_y_n,force_z_n\n";
  for (const auto& row : record.slave) {
    // The master's tool at the tick that the slave applies; before the first one there is nothing to show.
    const auto master =
        row.applied >= 0.0 ? master_at(record, row.applied, &MasterRow::tool_m) : std::nullopt;
    if (!master) continue;
    out += fmt::format(
        "{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{},{:.5f},{:.5f},{:.5f}\n",
        row.t_s - record.slave.front().t_s, master->x(), master->y(), master->z(), row.ref_m[0], row.ref_m[1],
        row.tool_m[0], row.tool_m[1], row.tool_m[2], row.laser_w, row.force_n[0], row.force_n[1],
        row.force_n[2]);
  }
  write_atomically(file, out);
}

/// Wood, burned where energy went; the contour as a thin blue line, the slave's path without laser as a grey
/// one.
cv::Mat draw_cut(const RunRecord& record) {
  double reach_m = 1e-3;
  for (const auto& point : record.contour_m) {
    reach_m = std::max({reach_m, std::abs(point[0]), std::abs(point[1])});
  }
  constexpr int kPixels = 1200;
  slave::Workpiece workpiece({.half_width_m = 1.2 * reach_m, .pixels = kPixels, .spot_radius_m = 60e-6});
  const double dt_s = figure(record.slave_figures, "control_period_s", tick_s(record.slave));
  for (const auto& row : record.slave) {
    if (row.laser_w > 0.0) workpiece.expose(plane(row.tool_m), row.laser_w * dt_s);
  }

  const slave::Material wood = slave::material("wood");
  const double full_j = 4.0 * workpiece.pixel_m() * workpiece.pixel_m() * 1e6;  // 4 J/mm^2 chars fully
  cv::Mat burnt;
  cv::exp(workpiece.energy_j() * (-3.0 / full_j), burnt);
  burnt = 1.0 - burnt;
  cv::Mat picture = slave::mark_picture(burnt, wood);

  constexpr int kShift = 4;
  const auto pixel = [&](const Vec2& point) {
    const cv::Point2d p = workpiece.pixel_of(point);
    return cv::Point(static_cast<int>(std::lround(p.x * (1 << kShift))),
                     static_cast<int>(std::lround(p.y * (1 << kShift))));
  };
  std::vector<cv::Point> path;
  const auto stroke = [&](const cv::Scalar& colour, bool closed) {
    if (path.size() > 1) cv::polylines(picture, path, closed, colour, 1, cv::LINE_AA, kShift);
    path.clear();
  };
  for (const auto& row : record.slave) {
    if (row.laser_w > 0.0) {
      stroke({140, 130, 120}, false);
    } else {
      path.push_back(pixel(plane(row.tool_m)));
    }
  }
  stroke({140, 130, 120}, false);
  for (const auto& point : record.contour_m) path.push_back(pixel({point[0], point[1]}));
  stroke({200, 110, 30}, record.contour_closed);

  slave::draw_scale_bar(picture, workpiece.pixel_m(), slave::ink_of(wood));
  return picture;
}

}  // namespace

bool stayed_inside(const nlohmann::ordered_json& report) {
  return report["cut"]["energy_outside_corridor_j"].get<double>() == 0.0;
}

void write_report(const std::filesystem::path& folder, const RunRecord& record) {
  const auto report = make_report(record);
  write_trace(folder / "trace.csv", record);
  if (!cv::imwrite((folder / "cut.png").string(), draw_cut(record))) {
    throw StartupError(fmt::format("{}: cannot be written", (folder / "cut.png").string()));
  }
  write_json(folder / "report.json", report);
}

}  // namespace telekerf::inspect
