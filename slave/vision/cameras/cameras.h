// SPDX-License-Identifier: Apache-2.0
// From what a user names as `camera` or `image` to a camera. A vendor enters a camera in cameras.cpp, and
// nowhere else.
#pragma once

#include <memory>
#include <string>

#include "slave/vision/cameras/camera.h"

namespace telekerf::vision_process {

/// How a `camera` may be written, one form after the other.
std::string camera_forms();
/// What is wrong with a `camera` as a user wrote it, and the remedy; empty: nothing.
std::string validate_camera(const std::string& camera);

/// A camera that has been seen to work. Throws StartupError: an unknown kind, or it shows nothing.
std::unique_ptr<Camera> open_camera(const std::string& camera);
/// A picture, drawing, folder of these, or video. Throws StartupError when there is no such thing.
std::unique_ptr<Camera> open_image(const std::string& path);

}  // namespace telekerf::vision_process
