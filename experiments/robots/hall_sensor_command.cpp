// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment hall-sensor: thesis 7.2.1, a motor's position from three analog Hall voltages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "common/reporting/plot.h"
#include "common/robot/hall_calibration.h"
#include "common/robot/hall_channels.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;
using reporting::Line;
using reporting::Panel;

struct Options : QuickForm {
  std::string robot = "slave-keops";
  double path_mm = 40.0;
  int sensors = 20;
  std::uint64_t seed = 1;
  std::string out = "out/hall-sensor";
};

/// Without noise and alike: what the converter leaves.
robot::Sensor ideal_of(robot::Sensor sensor) {
  sensor.noise = sensor.gain_mismatch = sensor.phase_mismatch_rad = sensor.offset_mismatch = 0.0;
  sensor.conversions = 1;
  return sensor;
}

/// Medians over the sensors of all seeds.
ordered_json accuracy(const robot::Sensor& sensor, const Options& options, bool calibrated) {
  std::vector<double> rms, worst;
  for (int i = 0; i < options.sensors; ++i) {
    const auto one = robot::hall_accuracy(sensor, 1e-3 * options.path_mm,
                                          options.seed + static_cast<std::uint64_t>(i), calibrated);
    rms.push_back(1e6 * one.rms_m);
    worst.push_back(1e6 * one.worst_m);
  }
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  return {{"rms_um", median(rms)}, {"max_um", median(worst)}};
}

/// A sweep over two pitches: voltages, and the position decoded from them with and without a calibration.
void draw(const robot::Sensor& spec, const Options& options, const std::filesystem::path& png) {
  constexpr int kSamples = 2000;
  robot::HallSensor sensor(spec, options.seed);
  std::vector<robot::HallCounts> sweep;
  for (int i = 0; i < kSamples; ++i) sweep.push_back(sensor.sample(2.0 * spec.pitch_m * i / kSamples));
  const auto calibration = robot::calibrate_hall(sweep, spec.adc_bits);
  robot::HallDecoder plain(spec.pitch_m, spec.adc_bits);
  robot::HallDecoder calibrated(spec.pitch_m, spec.adc_bits, calibration.value_or(robot::HallCalibration{}));
  std::array<Line, 3> voltages{Line{.label = "u1"}, Line{.label = "u2"}, Line{.label = "u3"}};
  Line truth{.label = "moved", .colour = 7},
      decoded{.label = "decoded", .style = Line::Style::kDashed, .colour = 1};
  Line without{.label = "as if ideal", .colour = 1}, with{.label = "calibrated", .colour = 0};
  for (int i = 0; i < kSamples; ++i) {
    const auto& counts = sweep[static_cast<std::size_t>(i)];
    const double at_m = 2.0 * spec.pitch_m * i / kSamples;
    const double a_m = plain.update(counts), b_m = calibrated.update(counts);
    if (i == 0) {
      plain.home(0.0);
      calibrated.home(0.0);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      voltages[k].x.push_back(1e3 * at_m);
      voltages[k].y.push_back(counts[k] * robot::volts_per_count(spec.adc_bits));
    }
    truth.x.push_back(1e3 * at_m);
    truth.y.push_back(1e3 * at_m);
    decoded.y.push_back(1e3 * (i == 0 ? 0.0 : b_m));
    without.y.push_back(i == 0 ? 0.0 : 1e6 * (a_m - at_m));
    with.y.push_back(i == 0 ? 0.0 : 1e6 * (b_m - at_m));
  }
  decoded.x = without.x = with.x = truth.x;
  reporting::draw_figure({.title = fmt::format("pitch {:g} mm, {} bits; the sensor of seed {}",
                                               1e3 * spec.pitch_m, spec.adc_bits, options.seed),
                          .panels = {{.title = "(147)-(149) voltages",
                                      .x_label = "position [mm]",
                                      .y_label = "share of the amplitude",
                                      .lines = {voltages.begin(), voltages.end()}},
                                     {.title = "(150)-(153) decoded position",
                                      .x_label = "position [mm]",
                                      .y_label = "[mm]",
                                      .lines = {truth, decoded}},
                                     {.title = "error as if all channels were alike",
                                      .x_label = "position [mm]",
                                      .y_label = "[um]",
                                      .lines = {without}},
                                     {.title = "error with the calibration",
                                      .x_label = "position [mm]",
                                      .y_label = "[um]",
                                      .lines = {with}}},
                          .columns = 2},
                         png);
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  robot::Sensor sensor = robot::load_robot(options.robot).sensor;
  sensor.kind = robot::Sensor::Kind::kHall;
  make_folder("--out", folder);
  ordered_json result{{"experiment", "hall-sensor"},
                      {"pitch_mm", 1e3 * sensor.pitch_m},
                      {"adc_bits", sensor.adc_bits},
                      {"conversions", sensor.conversions},
                      {"resolution_um", 1e6 * sensor.pitch_m / std::ldexp(1.0, sensor.adc_bits)}};
  result["ideal"] = accuracy(ideal_of(sensor), options, false);
  // As wide a step would have this rms error.
  result["ideal"]["step_um"] = std::sqrt(12.0) * result["ideal"]["rms_um"].get<double>();
  result["uncalibrated"] = accuracy(sensor, options, false);
  result["calibrated"] = accuracy(sensor, options, true);
  draw(sensor, options, folder / "hall-sensor.png");
  write_result(folder / "result.json", result, options.seed);
  fmt::print("{}\n", json_text(result));
  return 0;
}

}  // namespace

void add_hall_sensor_command(Program& program) {
  program.add(
      "hall-sensor", "Thesis 7.2.1: position from three Hall voltages; result.json, figure", Options{},
      [](Options& o, Settings& s) {
        s.add("robot", o.robot, kRobot, "whose sensors: a shipped name or a file");
        s.add("path_mm", o.path_mm, {.min = 1, .max = 500, .unit = "mm"}, "there and back");
        s.add("sensors", o.sensors, {.min = 1, .max = 1000}, "drawn with the seeds from --seed on");
        s.add("seed", o.seed, kSeeds, "of the first");
        o.add_quick(s);
        s.add("out", o.out, kFolder, "folder for the results");
      },
      run);
}

}  // namespace telekerf::experiments
