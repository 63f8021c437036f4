// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/imaging_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/startup_error.h"

namespace telekerf::imaging {
namespace {

/// A key, what it may be, and where its number lives: read and written by the same table.
struct Entry {
  std::string key;
  double* value;
  Bounds bounds;
};

std::vector<Entry> entries_of(ImagingFile& file) {
  Optics& optics = file.model.optics;
  std::vector<Entry> entries{
      {"optics.wavelength_m", &optics.wavelength_m, {.min = 1e-7, .max = 1e-5}},
      {"optics.numerical_aperture", &optics.numerical_aperture, {.min = 1e-3, .max = 1.6}},
      {"optics.refractive_index", &optics.refractive_index, {.min = 1.0, .max = 2.0}},
      {"optics.pixel_m", &optics.pixel_m, {.min = 1e-7, .max = 1e-3}},
      {"optics.sharpest_px", &optics.sharpest_px, {.min = 0.1, .max = 10.0}},
      {"coupling.focus_scale_per_m", &file.model.focus_scale_per_m, {.min = -100.0, .max = 100.0}},
      {"picture.distortion", &file.model.distortion, {.min = -0.3, .max = 0.3}},
  };
  static constexpr std::string_view kNames[kAxes] = {"magnification", "focus"};
  for (std::size_t i = 0; i < kAxes; ++i) {
    AxisModel& axis = file.axes[i];
    const auto key = [&](std::string_view name) { return fmt::format("{}.{}", kNames[i], name); };
    entries.insert(
        entries.end(),
        {{key("travel_m"), &axis.travel_m, {.min = 2e-3, .max = 1.0}},
         {key("moving_mass_kg"), &axis.moving_mass_kg, {.min = 1e-3, .max = 1e4}},
         {key("force_constant_n_per_a"), &axis.force_constant_n_per_a, {.min = 1e-3, .max = 1e6}},
         {key("peak_force_n"), &axis.peak_force_n, {.min = 1e-3, .max = 1e6}},
         {key("coulomb_n"), &axis.coulomb_n, {.min = 0.0, .max = 1e6}},
         {key("viscous_n_s_per_m"), &axis.viscous_n_s_per_m, {.min = 0.0, .max = 1e6}},
         {key("backlash_m"), &axis.backlash_m, {.min = 0.0, .max = 5e-3}},
         {key("speed_m_per_s"), &axis.speed_m_per_s, {.min = 1e-4, .max = 1.0}},
         {key("acceleration_m_per_s2"), &axis.acceleration_m_per_s2, {.min = 1e-3, .max = 100.0}}});
  }
  return entries;
}

std::string list_line(const char* name, std::span<const double> values) {
  std::string out;
  for (const double value : values) out += fmt::format("{}{}", out.empty() ? "" : ", ", value);
  return fmt::format("{} = [{}]\n", name, out);
}

/// What the numbers make of it together: a file of another unit, or in other units, is refused.
void check(const ConfigFile& config, const ImagingModel& model) {
  constexpr Bounds kPixel_m{.min = 1e-8, .max = 1e-2};
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const double s = 0.25 * quarter;
    const double at_m = s * model.magnification_travel_m;
    const double focus_m = model.best_focus_m(at_m);
    if (!(focus_m >= -model.focus_travel_m && focus_m <= 2.0 * model.focus_travel_m)) {
      config.refuse(
          "coupling.ridge_m",
          fmt::format("puts the focus at {:g} m where the magnification is at {:g} of its travel; the "
                      "travel is [0, {:g}] m; calibrate anew",
                      focus_m, s, model.focus_travel_m));
    }
    const double pixel_m = model.metres_per_pixel({at_m, focus_m});
    if (!(pixel_m >= kPixel_m.min && pixel_m <= kPixel_m.max)) {
      config.refuse("coupling.log_scale",
                    fmt::format("makes a pixel {:g} m wide where the magnification is at {:g} of its travel; "
                                "it must lie within [{:g}, {:g}] m; calibrate anew",
                                pixel_m, s, kPixel_m.min, kPixel_m.max));
    }
  }
  constexpr double kDarkest = 0.05;
  const cv::Size picture(200, 150);
  for (const double x : {0.0, 99.5, 199.0}) {
    for (const double y : {0.0, 74.5, 149.0}) {
      if (const double light = model.light(x, y, picture); !(light >= kDarkest)) {
        config.refuse(
            "picture.flat_field",
            fmt::format("leaves {:g} of the light at a corner of the picture; at least {:g} must be "
                        "left; calibrate anew",
                        light, kDarkest));
      }
    }
  }
}

struct ListEntry {
  const char* key;
  std::span<double> values;
};

std::vector<ListEntry> lists_of(ImagingFile& file) {
  return {{"coupling.log_scale", file.model.log_scale},
          {"coupling.ridge_m", file.model.ridge_m},
          {"picture.flat_field", file.model.flat_field}};
}

ImagingFile read(const ConfigFile& config) {
  ImagingFile file;
  for (const Entry& entry : entries_of(file))
    *entry.value = config.number_or(entry.key, *entry.value, entry.bounds);
  for (const ListEntry& list : lists_of(file)) {
    if (!config.has(list.key)) continue;
    const auto given = config.numbers(list.key, list.values.size(), {.min = -100.0, .max = 100.0});
    std::copy(given.begin(), given.end(), list.values.begin());
  }
  config.refuse_unknown();
  file.model.magnification_travel_m = file.axes[kMagnification].travel_m;
  file.model.focus_travel_m = file.axes[kFocus].travel_m;
  check(config, file.model);
  return file;
}

}  // namespace

ImagingFile default_imaging() {
  ImagingFile file;
  file.model.optics.pixel_m *= 2.0;
  file.model.log_scale[0] += std::log(2.0);
  return file;
}

ImagingFile load_imaging(const std::string& path) {
  const ConfigFile config{std::filesystem::path(path)};
  ImagingFile any;
  const auto given = [&](const auto& entry) { return config.has(entry.key); };
  if (std::ranges::none_of(entries_of(any), given) && std::ranges::none_of(lists_of(any), given))
    throw configuration_error(
        fmt::format("{}: is empty, or has lost its figures; telekerf-vision --calibrate writes such a file", path));
  return read(config);
}

ImagingFile parse_imaging(const std::string& toml, const std::string& name) {
  return read(ConfigFile(toml, name));
}

std::string imaging_toml(const ImagingFile& given) {
  ImagingFile file = given;
  std::string out = "# An imaging unit; see docs/how-to/imaging-unit.md.\n";
  std::string table;
  const auto open = [&](const std::string& key) {
    const std::string now = key.substr(0, key.find('.'));
    if (now != table) out += fmt::format("\n[{}]\n", now);
    table = now;
    return key.substr(key.find('.') + 1);
  };
  for (const Entry& entry : entries_of(file)) {
    out += fmt::format("{} = {}\n", open(entry.key), *entry.value);
    if (entry.key == "coupling.focus_scale_per_m") {
      out += list_line("log_scale", file.model.log_scale) + list_line("ridge_m", file.model.ridge_m);
    }
    if (entry.key == "picture.distortion") out += list_line("flat_field", file.model.flat_field);
  }
  return out;
}

}  // namespace telekerf::imaging
