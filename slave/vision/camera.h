// SPDX-License-Identifier: Apache-2.0
// Where pictures come from: a hardware vendor implements `Camera`; here are files, folders, videos and V4L2.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>

namespace telekerf::vision {

/// What a camera showed. Files are named, not read: a drawing has no pixels, a large picture is read reduced.
struct Frame {
  std::string source;    ///< file or camera, as people know it
  std::string file;      ///< to be read; empty when `image` holds the picture
  cv::Mat image = {};    ///< any depth, 1, 3 or 4 channels
  bool settles = false;  ///< one of many a second: a contour counts when several frames agree
};

class Camera {
 public:
  /// A new frame, or nothing new, or the reason why the camera is gone.
  using Look = tl::expected<std::optional<Frame>, std::string>;

  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// Never waits longer than a frame's time, or what the driver takes to find out that its device is gone. A
  /// camera that is gone is looked for again at each call.
  virtual Look next() = 0;
};

/// A picture, drawing, folder of pictures (in the order of their names) or video; what is changed or added
/// later is a new frame. Throws StartupError when there is no such thing.
std::unique_ptr<Camera> open_image(const std::string& path);
/// Device /dev/videoN. Throws StartupError when it cannot be opened.
std::unique_ptr<Camera> open_device(int number);

}  // namespace telekerf::vision
