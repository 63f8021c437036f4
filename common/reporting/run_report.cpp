// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/geometry/corridor.h"
#include "common/geometry/nearest.h"
#include "common/reporting/cut_picture.h"
#include "common/reporting/picture_file.h"
#include "common/reporting/run_lookup.h"
#include "common/reporting/run_trace.h"
#include "common/reporting/tracking_error.h"
#include "common/runtime/error_statistics.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"

namespace telekerf::reporting {
namespace {

nlohmann::ordered_json um(const ErrorStatistics& spread, const char* rms_um = "rms_um") {
  if (spread.count == 0) return {{rms_um, nullptr}, {"max_um", nullptr}, {"samples", 0}};
  return {{rms_um, spread.rms() * 1e6}, {"max_um", spread.max * 1e6}, {"samples", spread.count}};
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

/// The force that reached the master, and how far it was off what the slave estimated at the same tick.
nlohmann::ordered_json force_json(const RunRecord& record) {
  ErrorStatistics force;
  ErrorStatistics coding;
  std::size_t samples = 0;
  for (const MasterRow& row : record.master) {
    if (row.force_tick < 0.0 || record.slave.empty()) continue;
    const double place = row.force_tick - static_cast<double>(record.slave.front().tick);
    if (!(place >= 0.0) || place > static_cast<double>(record.slave.size() - 1)) continue;
    const Vec3& sent = record.slave[static_cast<std::size_t>(place)].force_n;
    for (int i = 0; i < 3; ++i) {
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
          {"bits_per_sample", metric(record.slave_figures, "force_bits_per_sample")},
          {"samples", samples}};
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
  return {{"rate_hz", metric(figures, "rate_hz")},
          {"slack_us", {{"p50", metric(figures, "slack_p50_us")}, {"p99", metric(figures, "slack_p99_us")}}},
          {"overruns", static_cast<std::int64_t>(metric(figures, "overruns"))},
          {"readings_missed", static_cast<std::int64_t>(metric(figures, "readings_missed"))}};
}

}  // namespace

nlohmann::ordered_json make_report(const RunRecord& record) {
  if (record.contour_m.size() < 2) throw input_error("the run has no contour: nothing to report");
  const Contours contours(record);
  const geometry::NearestIndex& contour = contours.last();
  const double dt_s = control_period_s(record);

  ErrorStatistics constraint;
  for (const auto& row : record.master) {
    // In the master's size: to contour / beta.
    const auto& guiding = contours.at(static_cast<double>(row.tick));
    if (row.guided) constraint.add(guiding.find(row.beta * in_plane(row.tool_m)).distance_m / row.beta);
  }

  const TrackingError error = tracking_error(record);
  ErrorStatistics cut;
  Coverage coverage(contour);
  double laser_on_s = 0.0;
  double inside_j = 0.0;
  double outside_j = 0.0;
  std::optional<geometry::Nearest> previous;
  double applied = std::numeric_limits<double>::infinity();
  for (const auto& row : record.slave) {
    if (row.applied >= 0.0) applied = row.applied;
    if (row.laser_w <= 0.0) {
      previous.reset();
      continue;
    }
    const geometry::NearestIndex& in_force = contours.at(applied);
    const geometry::Nearest nearest = in_force.find(in_plane(row.tool_m));
    cut.add(nearest.distance_m);
    laser_on_s += dt_s;
    (nearest.distance_m <= geometry::kCorridorHalfWidth_m ? inside_j : outside_j) += row.laser_w * dt_s;
    if (&in_force == &contour && nearest.distance_m <= geometry::kCorridorHalfWidth_m) {
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
  if (!record.earlier.empty()) report["contour"]["earlier"] = record.earlier.size();
  report["beta"] = metric(record.master_figures, "beta", 1.0);
  report["law"] = word(record, "law");
  report["estimator"] = word(record, "estimator");
  report["drive"] = {{"master", words_of(record.master_drive)}, {"slave", words_of(record.slave_drive)}};
  report["constraint"] = um(constraint);
  report["tracking"] = um(error.tracking);
  report["tracking"]["laser_on"] = um(error.laser_on);
  report["tracking"]["settled"] = um(error.settled_tracking);
  report["tracking"]["settled"]["left_out"] = error.left_out();
  report["prediction"] = um(error.prediction, "rmse_um");
  report["prediction"]["settled"] = um(error.settled_prediction, "rmse_um");
  report["prediction"]["settled"]["left_out"] = error.left_out();
  report["cut"] = cut_json;
  report["link"] = {{"rtt_ms",
                     {{"p50", known({{&m, "rtt_p50_ms"}})},
                      {"p95", known({{&m, "rtt_p95_ms"}})},
                      {"p99", known({{&m, "rtt_p99_ms"}})}}},
                    {"block_ms", metric(m, "block_ms")},
                    {"playout_ms", metric(s, "playout_ms")},
                    {"total_ms", known({{&m, "rtt_p50_ms"}, {&m, "block_ms"}, {&s, "playout_ms"}})},
                    {"command_age_ms",
                     {{"mean", known({{&s, "command_age_mean_ms"}})},
                      {"max", known({{&s, "command_age_max_ms"}})},
                      {"beam", known({{&s, "beam_age_ms"}})}}},
                    {"lost", static_cast<std::int64_t>(metric(s, "lost") + metric(m, "lost"))},
                    {"refused", static_cast<std::int64_t>(metric(s, "refused") + metric(m, "refused"))},
                    {"payload_bytes_per_s", metric(m, "payload_bytes_per_s")},
                    {"wire_bytes_per_s", metric(m, "wire_bytes_per_s")},
                    {"packets_per_s", metric(m, "packets_per_s")}};
  report["codec"] = {
      {"name", word(record, "codec")},
      {"block", static_cast<std::int64_t>(metric(m, "block"))},
      {"kept", static_cast<std::int64_t>(metric(m, "keep"))},
      {"max_rms", metric(m, "max_rms")},
      {"redundancy", static_cast<std::int64_t>(metric(m, "redundancy"))},
      {"copies",
       {{"mean", metric(m, "copies_mean")}, {"max", static_cast<std::int64_t>(metric(m, "copies_max"))}}},
      {"bits_per_sample", metric(m, "bits_per_sample")}};
  report["force"] = force_json(record);
  report["loop"] = {{"master", loop_json(m)}, {"slave", loop_json(s)}};
  report["seed"] = static_cast<std::int64_t>(metric(m, "seed"));
  report["netem"] = word(record, "netem");
  report["version"] = kVersion;
  return report;
}

bool stayed_inside(const nlohmann::ordered_json& report) {
  return report["cut"]["energy_outside_corridor_j"].get<double>() == 0.0;
}

bool succeeded(const nlohmann::ordered_json& report) {
  return stayed_inside(report) && report["cut"]["coverage"].get<double>() > 0.0;
}

nlohmann::ordered_json write_report(const std::filesystem::path& folder, const RunRecord& record) {
  nlohmann::ordered_json report = make_report(record);
  write_run_trace(folder / "trace.csv", record);
  write_picture(folder / "cut.png", draw_cut(record));
  write_json(folder / "report.json", report);
  return report;
}

}  // namespace telekerf::reporting
