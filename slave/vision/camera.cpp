// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "common/runtime/startup_error.h"

namespace telekerf::vision {
namespace {

namespace fs = std::filesystem;

std::string kind_of(const fs::path& file) {
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return kind;
}

bool is_one_of(const fs::path& file, std::initializer_list<const char*> kinds) {
  return std::find(kinds.begin(), kinds.end(), kind_of(file)) != kinds.end();
}

bool is_video(const fs::path& file) {
  return is_one_of(file, {".avi", ".mp4", ".m4v", ".mkv", ".mov", ".webm", ".mpg", ".mpeg", ".ogv"});
}

bool is_picture(const fs::path& file) {
  return is_one_of(file, {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm", ".pbm",
                          ".pnm", ".jp2", ".svg", ".dxf"});
}

/// Tells a file that was written anew from one that was not.
struct Stamp {
  fs::file_time_type written;
  std::uintmax_t size = 0;
  bool operator==(const Stamp&) const = default;
};

std::optional<Stamp> stamp_of(const fs::path& file) {
  std::error_code error;
  const Stamp stamp{fs::last_write_time(file, error), fs::file_size(file, error)};
  return error ? std::nullopt : std::optional(stamp);
}

class FileCamera : public Camera {
 public:
  explicit FileCamera(fs::path file) : file_(std::move(file)) {}

  Look next() override {
    const auto stamp = stamp_of(file_);
    if (!stamp) return tl::unexpected(fmt::format("{}: cannot be read", file_.string()));
    if (stamp == seen_) return std::nullopt;
    seen_ = stamp;
    return Frame{file_.filename().string(), file_.string()};
  }

 private:
  fs::path file_;
  std::optional<Stamp> seen_;
};

class FolderCamera : public Camera {
 public:
  explicit FolderCamera(fs::path folder) : folder_(std::move(folder)) {}

  Look next() override {
    std::error_code error;
    std::map<fs::path, Stamp> files;
    for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
      if (!is_picture(at->path())) continue;
      if (const auto stamp = stamp_of(at->path())) files.emplace(at->path(), *stamp);
    }
    if (error) return tl::unexpected(fmt::format("{}: cannot be read", folder_.string()));
    if (files.empty()) return tl::unexpected(fmt::format("{}: there is no picture in it", folder_.string()));
    for (const auto& [file, stamp] : files) {
      const auto seen = seen_.find(file);
      if (seen != seen_.end() && seen->second == stamp) continue;
      seen_[file] = stamp;
      return Frame{file.filename().string(), file.string()};
    }
    return std::nullopt;
  }

 private:
  fs::path folder_;
  std::map<fs::path, Stamp> seen_;
};

/// A video file at its own pace, or a device at its; both through OpenCV.
class CaptureCamera : public Camera {
 public:
  CaptureCamera(std::string name, fs::path file, int device)
      : name_(std::move(name)), file_(std::move(file)), device_(device) {}

  Look next() override {
    if (!capture_.isOpened()) {
      const auto stamp = file_.empty() ? std::nullopt : stamp_of(file_);
      if (stamp && stamp == finished_) return std::nullopt;  // shown to its end
      if (!open()) return tl::unexpected(fmt::format("{}: cannot be opened", name_));
      opened_ = stamp;
      shown_ = 0;
    }
    cv::Mat image;
    if (!capture_.read(image) || image.empty()) {
      const bool ended = !file_.empty() && shown_ > 0;
      capture_.release();
      if (!ended) return tl::unexpected(fmt::format("{}: gives no picture", name_));
      finished_ = opened_;
      return std::nullopt;
    }
    if (!file_.empty()) keep_pace();
    ++shown_;
    return Frame{name_, "", std::move(image), true};
  }

 private:
  bool open() {
    // A device that is not there yet is no news; what can be said is said once, in a sentence of ours.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    // Each by name: left to choose, OpenCV asks every photo camera on USB for a file that it cannot read.
    return file_.empty() ? capture_.open(device_, cv::CAP_V4L2)
                         : capture_.open(file_.string(), cv::CAP_FFMPEG);
  }

  void keep_pace() {
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    const auto now = std::chrono::steady_clock::now();
    if (shown_ == 0 || !(rate > 1.0)) {
      due_ = now;
      return;
    }
    due_ = std::max(due_ + std::chrono::microseconds(static_cast<long>(1e6 / rate)),
                    now - std::chrono::seconds(1));
    std::this_thread::sleep_until(due_);
  }

  std::string name_;
  fs::path file_;
  int device_;
  cv::VideoCapture capture_;
  std::optional<Stamp> opened_;
  std::optional<Stamp> finished_;
  int shown_ = 0;
  std::chrono::steady_clock::time_point due_;
};

using Make = std::function<std::unique_ptr<Camera>()>;

/// Looks once, so that what is not there is refused at the start.
std::unique_ptr<Camera> proven(const Make& make, const char* remedy) {
  if (const auto look = make()->next(); !look)
    throw StartupError(fmt::format("{}; {}", look.error(), remedy));
  return make();
}

}  // namespace

std::unique_ptr<Camera> open_image(const std::string& path) {
  Make make = [&] { return std::make_unique<FileCamera>(path); };
  if (fs::is_directory(path)) {
    make = [&] { return std::make_unique<FolderCamera>(path); };
  } else if (is_video(path)) {
    make = [&] { return std::make_unique<CaptureCamera>(fs::path(path).filename().string(), path, 0); };
  }
  return proven(make, "--image takes a picture, an SVG or DXF file, a folder of them, or a video");
}

std::unique_ptr<Camera> open_device(int number) {
  return proven([&] { return std::make_unique<CaptureCamera>(fmt::format("camera {}", number), "", number); },
                "--camera takes the number of a /dev/video device");
}

}  // namespace telekerf::vision
