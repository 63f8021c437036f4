// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include "common/runtime/clock.h"
#include "common/runtime/loop.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/vision/raster/picture_file.h"
#include "slave/vision/cameras/cameras.h"
#include "slave/vision/imaging/calibration.h"
#include "slave/vision/imaging/imaging_file.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::vision_process {
namespace {

using namespace imaging;
using Clock = std::chrono::steady_clock;

constexpr double kUsualWidth_m = 0.03;
constexpr std::chrono::milliseconds kFrame{50};
constexpr std::chrono::seconds kSilence{2};  ///< of axes that are given up at the start

/// What a driver of Linux keeps in its buffers.
int late_frames(const ImagingFlags& flags) { return flags.imaging == "simulated" ? 0 : 4; }

ImagingFile file_of(const ImagingFlags& flags) {
  return flags.imaging_file.empty() ? default_imaging() : load_imaging(flags.imaging_file);
}

/// How long axes are waited for: half as long again as they can take.
Clock::duration patience(const AxesModel& axes) {
  return std::chrono::seconds(5) + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(1.5 * AxesControl::longest_way_s(axes)));
}

/// Opened and moving; homed or refused.
std::shared_ptr<AxesRunner> running_axes(const ImagingFlags& flags, const ImagingFile& file) {
  auto runner = std::make_shared<AxesRunner>(
      open_axes(flags.imaging, {.model = file.axes, .period_s = AxesRunner::kPeriod_s}), file.axes);
  runner->start();
  const auto until = Clock::now() + patience(file.axes);
  auto heard = Clock::now();
  while (runner->state() != AxesControl::State::kReady && Clock::now() < until && !stop_requested()) {
    if (runner->state() != AxesControl::State::kLost) heard = Clock::now();
    if (Clock::now() - heard > kSilence) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (runner->state() == AxesControl::State::kReady) return runner;
  throw hardware_error(
      fmt::format("imaging = {}: the axes have not found their lower ends; switch them on, and see "
                  "docs/how-to/imaging-unit.md",
                  flags.imaging));
}

ImagingCamera::Source source_of(const ImagingFlags& flags, const ImagingModel& model, const cv::Mat& picture,
                                double width_m, const std::string& camera) {
  if (flags.imaging == "simulated") return simulated_source(model, picture, width_m);
  if (camera == "none")
    throw usage_error(
        fmt::format("imaging = {}: --camera must say which camera looks through it", flags.imaging));
  if (camera.starts_with("file:") || camera.starts_with("folder:"))
    throw usage_error(
        fmt::format("imaging = {}: --camera {} shows files, not what lies under the axes; it must be a live "
                    "one, v4l2:N or "
                    "video:PATH",
                    flags.imaging, camera));
  return camera_source(open_camera(camera));
}

/// Until the next picture of a stream is due.
ImagingCamera::Wait pace() {
  return [due_ns = monotonic_ns()]() mutable {
    due_ns = next_deadline_ns(due_ns, std::chrono::nanoseconds(kFrame).count(), monotonic_ns());
    sleep_until_ns(due_ns);
  };
}

tl::expected<void, std::string> arrive(const AxesRunner& axes, Clock::duration patience) {
  const auto until = Clock::now() + patience;
  while (!axes.settled()) {
    if (axes.state() != AxesControl::State::kReady || Clock::now() > until || stop_requested())
      return tl::unexpected<std::string>("the axes do not arrive where they are sent");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return {};
}

/// The first picture that was taken from now on, behind `late` older ones.
tl::expected<cv::Mat, std::string> picture_now(const ImagingCamera::Source& source, const AxesRunner& axes,
                                               int late) {
  constexpr int kMostWaits = 100;
  for (int waits = 0; waits < kMostWaits;) {
    auto seen = source(axes.optics_m(), axes.time_s());
    if (!seen) return tl::unexpected(seen.error());
    if (!*seen || (*seen)->image.empty()) {
      ++waits;
      std::this_thread::sleep_for(kFrame);
      continue;
    }
    if (late-- > 0) continue;
    if (const std::string wrong = focus_complaint((*seen)->image); !wrong.empty())
      return tl::unexpected(wrong);
    return focus_grey((*seen)->image);
  }
  return tl::unexpected<std::string>("the camera gives no pictures");
}

}  // namespace

std::string ImagingFlags::warning() const {
  if (!wanted() || imaging == "simulated" || !imaging_file.empty()) return {};
  return "warning: without --imaging-file the simulated unit's scale is taken for this one's, and what is cut has another "
         "size than it shows; calibrate with --calibrate FILE and name that file";
}

void ImagingFlags::add_parameters(Settings& settings) {
  settings.add("imaging", imaging,
               device_form("none, " + axes_forms(),
                           [](const std::string& axes) {
                             return axes == "none" ? std::string() : validate_axes(axes);
                           }),
               "the axes of an imaging unit, which zoom and keep the picture sharp");
  settings.add("imaging_file", imaging_file, kFile,
               "the unit's optics, axes and calibration; without it: simulated ones");
  settings.add("law", law, kFocusLaws, "how the focus is found and kept");
  settings.add("zoom", zoom, {.min = 0, .max = 1},
               "where the magnification axis goes first, share of its travel");
  settings.add("focus_region", focus_region, {.min = 0.05, .max = 1},
               "part of the picture about its middle that is to be sharp, share of width and height");
  settings.add("calibrate", calibrate, kName,
               "calibrates with the printed grid, writes this imaging_file and ends");
  settings.add("grid_mm", grid_mm, {.min = 0.01, .max = 100, .unit = "mm"},
               "from dot to dot of the printed grid");
  settings.not_with({"imaging_file", "law", "zoom", "focus_region", "grid_mm"}, "imaging", {"none"});
  settings.not_with({"camera"}, "imaging", {"simulated"});
}

std::unique_ptr<ImagingCamera> open_imaging(const ImagingFlags& flags, const std::string& image,
                                            double width_m, const std::string& camera) {
  const ImagingFile file = file_of(flags);
  cv::Mat picture;
  if (flags.imaging == "simulated") {
    const auto read = vision::read_picture(image);
    if (!read) throw input_error(read.error());
    picture = read->image;
  }
  auto source = source_of(flags, file.model, picture, width_m > 0.0 ? width_m : kUsualWidth_m, camera);
  const ImagingCameraSettings settings{.model = file.model,
                                       .law = flags.law,
                                       .magnification = flags.zoom,
                                       .region = flags.focus_region,
                                       .frame_period_s = std::chrono::duration<double>(kFrame).count(),
                                       .late_frames = late_frames(flags)};
  // A camera sets its own pace.
  return std::make_unique<ImagingCamera>(settings, running_axes(flags, file), std::move(source),
                                         flags.imaging == "simulated" ? pace() : ImagingCamera::Wait([] {}));
}

void run_calibration(const ImagingFlags& flags, const std::string& camera) {
  if (!flags.wanted()) {
    throw usage_error(fmt::format("calibrate = {}: --imaging must say which axes are calibrated: {}",
                                  flags.calibrate, axes_forms()));
  }
  // What cannot be written is better known before than afterwards.
  refuse_unwritable("--calibrate", std::filesystem::absolute(flags.calibrate).parent_path());
  if (std::filesystem::is_directory(flags.calibrate)) {
    throw usage_error(fmt::format("calibrate = {}: is a folder; name the file to be written in it, as {}",
                                  flags.calibrate, (std::filesystem::path(flags.calibrate) / "unit.toml").string()));
  }
  ImagingFile file = file_of(flags);
  CalibrationSettings settings;
  settings.pitch_m = 1e-3 * flags.grid_mm;
  settings.region = flags.focus_region;
  // Forty texels from dot to dot, and 40 mm of it.
  constexpr double kTexels = 40.0;
  const int size = static_cast<int>(std::clamp(0.04 / settings.pitch_m * kTexels, 200.0, 4000.0));
  const cv::Mat grid = draw_target(Target::kGrid, size, kTexels, 1);
  const auto source = source_of(flags, file.model, grid, size * settings.pitch_m / kTexels, camera);
  const auto axes = running_axes(flags, file);
  const CalibrationRig rig{.zoom =
                               [&](double to_m) {
                                 axes->move_to(kMagnification, to_m);
                                 return arrive(*axes, patience(file.axes));
                               },
                           .look = [&](double to_m) -> tl::expected<cv::Mat, std::string> {
                             axes->approach(kFocus, to_m);
                             if (const auto there = arrive(*axes, patience(file.axes)); !there)
                               return tl::unexpected(there.error());
                             return picture_now(source, *axes, late_frames(flags));
                           },
                           .positions = [&] { return axes->positions_m(); },
                           .lowest_m = axes->lowest_m(),
                           .highest_m = axes->highest_m(kFocus)};
  const auto calibration = calibrate(rig, file.model, settings);
  if (!calibration)
    throw hardware_error(fmt::format("calibrate = {}: {}", flags.calibrate, calibration.error()));
  file.model = calibration->model;
  write_atomically(flags.calibrate, imaging_toml(file));
  for (std::size_t i = 0; i < calibration->views.size(); ++i) {
    fmt::print(
        "vision: magnification axis at {:.1f} mm: {:.3f} um a pixel, {} dots, {:.2f} pixels off their "
        "lattice\n",
        1e3 * calibration->places[i].magnification_m, 1e6 * calibration->views[i].metres_per_pixel,
        calibration->views[i].dots, calibration->views[i].residual_px);
  }
  fmt::print("vision: calibrated to {:.3f} % of a pixel's size, distortion {:.4f}: {}\n",
             100.0 * calibration->scale_residual, calibration->model.distortion, flags.calibrate);
}

}  // namespace telekerf::vision_process
