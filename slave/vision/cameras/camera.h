// SPDX-License-Identifier: Apache-2.0
// The seam to whatever shows the workpiece: a hardware vendor implements `Camera` and enters it in
// cameras.cpp.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/runtime/device_registry.h"

namespace telekerf::vision_process {

/// What a camera showed. Files are named, not read: a drawing has no pixels, a large picture is read reduced.
struct Frame {
  std::string source;    ///< file or camera, as people know it
  std::string file;      ///< to be read; empty when `image` holds the picture
  cv::Mat image = {};    ///< any depth, 1, 3 or 4 channels
  bool settles = false;  ///< one of many a second: a contour counts when several frames agree
  /// Size of a pixel on the workpiece, of a camera that knows it; it wins over every other size.
  std::optional<double> metres_per_pixel = std::nullopt;
};

class Camera {
 public:
  /// A new frame, or nothing new, or the reason why the camera is gone.
  using Result = tl::expected<std::optional<Frame>, std::string>;

  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// Never waits longer than a frame's time, or what the driver takes to find out that its device is gone. A
  /// camera that is gone is looked for again at each call.
  virtual Result next() = 0;
};

/// How users name cameras: each kind has a row of its own beside its class.
using CameraRegistry = DeviceRegistry<std::unique_ptr<Camera>>;
using CameraKind = CameraRegistry::Kind;

/// Validates what stands behind the colon of a camera that shows files.
inline std::string validate_path(std::string_view path) {
  return path.empty() ? "a path must follow the colon" : "";
}

}  // namespace telekerf::vision_process
