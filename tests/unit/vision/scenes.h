// SPDX-License-Identifier: Apache-2.0
// What a camera could show, and a folder to show it from.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "slave/vision/contour_source.h"
#include "tools/draw-pictures/rendering.h"

namespace telekerf::vision_process {

inline cv::Mat picture_of(const std::string& name, std::uint64_t seed = 1, const Vec2& shift = Vec2::Zero()) {
  const auto drawing = drawing::transformed(*drawing::by_name(name), 0.0, 0.8, Vec2(319.5, 239.5), shift);
  return drawing::render(drawing, {.noise = 6.0, .seed = seed});
}

inline ContourRequest at_true_size() {
  ContourRequest request;
  request.width_m = 0.03;
  request.anchor = vision::AnchorMode::kImageCentre;
  return request;
}

class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::path(testing::TempDir()) / ("telekerf_" + name + "_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  void put(const std::string& name, const cv::Mat& image) const {
    ASSERT_TRUE(cv::imwrite(file("new.part.png"), image));
    std::filesystem::rename(file("new.part.png"), file(name));
  }

 private:
  std::filesystem::path path_;
};

}  // namespace telekerf::vision_process
