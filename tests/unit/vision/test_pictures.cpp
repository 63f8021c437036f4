// SPDX-License-Identifier: Apache-2.0
// Files: shipped pictures, damaged ones, and the photographs of Debian's opencv-doc, where it is installed.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/vision/load.h"
#include "common/vision/raster/picture_file.h"

namespace telekerf::vision {
namespace {

namespace fs = std::filesystem;

fs::path scratch(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / "telekerf_pictures";
  fs::create_directories(folder);
  return folder / name;
}

TEST(Pictures, EveryShippedPictureBecomesAContour) {
  std::size_t seen = 0;
  for (const auto& entry : fs::directory_iterator(TELEKERF_PICTURES)) {
    if (entry.path().extension() != ".png") continue;
    ++seen;
    const auto found = load_contours(entry.path().string(), {});
    ASSERT_TRUE(found) << found.error();
    const geometry::Polyline& line = found->contours.front();
    EXPECT_GT(line.size(), 100u) << entry.path();
    EXPECT_NEAR(geometry::bounding_circle(line.points_m).radius_m, 0.6 * 0.03, 1e-9);
    const bool open = entry.path().stem() == "line" || entry.path().stem() == "letter-s" ||
                      entry.path().stem() == "script-e" || entry.path().stem() == "spiral";
    EXPECT_EQ(line.closed, !open) << entry.path();
  }
  EXPECT_GE(seen, 12u);
}

TEST(Pictures, DamagedFilesAreRefused) {
  const auto complaint = [](const fs::path& file) {
    const auto found = load_contours(file.string(), {});
    return found ? std::string() : found.error();
  };
  EXPECT_NE(complaint("/nonexistent/picture.png").find("cannot be read"), std::string::npos);
  EXPECT_NE(complaint(fs::temp_directory_path()), "");
  std::ofstream(scratch("empty.png")).flush();
  EXPECT_NE(complaint(scratch("empty.png")), "");
  std::ofstream(scratch("text.png"))
      << "this is not a picture at all, but long enough to be read as a header";
  EXPECT_NE(complaint(scratch("text.png")), "");
  // A whole picture, cut at every tenth of its length: decoders fill up what is missing, and half a contour
  // is none.
  cv::Mat picture(200, 300, CV_8U, cv::Scalar(220));
  cv::circle(picture, {150, 100}, 60, cv::Scalar(30), -1);
  for (const char* kind : {".png", ".jpg", ".bmp", ".tiff"}) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(kind, picture, bytes));
    for (int tenth = 0; tenth < 10; ++tenth) {
      std::ofstream(scratch(std::string("cut") + kind), std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size() * tenth / 10));
      EXPECT_NE(complaint(scratch(std::string("cut") + kind)), "")
          << kind << " cut at " << tenth << " tenths";
    }
  }
}

TEST(Pictures, AHeaderCannotAskForGigabytes) {
  // A PNG head that promises 60000 x 60000 pixels.
  const unsigned char head[33] = {0x89, 'P',  'N', 'G', 13,  10, 26, 10,   0,    0, 0,
                                  13,   'I',  'H', 'D', 'R', 0,  0,  0xea, 0x60, 0, 0,
                                  0xea, 0x60, 8,   2,   0,   0,  0,  0,    0,    0, 0};
  std::ofstream(scratch("huge.png"), std::ios::binary)
      .write(reinterpret_cast<const char*>(head), sizeof head);
  const auto found = read_picture(scratch("huge.png").string());
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().find("too large"), std::string::npos);
}

TEST(Pictures, EveryFormatsHeaderIsReadFirst) {
  const auto complaint = [](const std::string& name, const std::string& bytes) {
    std::ofstream(scratch(name), std::ios::binary) << bytes;
    const auto found = read_picture(scratch(name).string());
    return found ? std::string() : found.error();
  };
  using namespace std::string_literals;
  const std::string zeros(64, '\0');
  const std::string tiff =
      "II*\0\x08\0\0\0\x02\0"
      "\0\x01\x04\0\x01\0\0\0\x60\xea\0\0"
      "\x01\x01\x04\0\x01\0\0\0\x60\xea\0\0"s;
  EXPECT_NE(complaint("huge.tiff", tiff + zeros).find("3600 Mpx"), std::string::npos);
  EXPECT_NE(complaint("huge.pgm", "P5\n# a comment\n60000 60000\n255\n" + zeros).find("3600 Mpx"),
            std::string::npos);
  EXPECT_NE(complaint("huge.bmp", "BM" + std::string(16, '\0') + "\x60\xea\0\0\x60\xea\0\0"s + zeros)
                .find("3600 Mpx"),
            std::string::npos);
}

TEST(Pictures, FilesOfSixteenBitsWithHotPixelsAndWithAlpha) {
  cv::Mat grey(240, 320, CV_16U, cv::Scalar(3000));
  cv::circle(grey, {160, 120}, 80, cv::Scalar(2000), 5);
  grey.at<std::uint16_t>(5, 7) = 65535;
  cv::Mat alpha(240, 320, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  cv::circle(alpha, {160, 120}, 80, cv::Scalar(0, 0, 0, 255), 5, cv::LINE_AA);
  for (const cv::Mat& picture : {grey, alpha}) {
    ASSERT_TRUE(cv::imwrite(scratch("depth.png").string(), picture));
    LoadRequest request;
    request.scale.picture_width_m = 0.032;
    const auto found = load_contours(scratch("depth.png").string(), request);
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->mode, "stroke");
    EXPECT_TRUE(found->contours.front().closed);
    EXPECT_NEAR(geometry::length_m(found->contours.front()), 2 * M_PI * 8e-3, 0.2e-3);
  }
}

TEST(Pictures, LargePicturesAreReducedAndKeepTheirSize) {
  cv::Mat picture(5000, 6000, CV_8U, cv::Scalar(220));
  cv::circle(picture, {3000, 2500}, 2000, cv::Scalar(30), -1);
  ASSERT_TRUE(cv::imwrite(scratch("large.png").string(), picture, {cv::IMWRITE_PNG_COMPRESSION, 1}));
  LoadRequest request;
  request.scale.picture_width_m = 0.06;
  const auto found = load_contours(scratch("large.png").string(), request);
  ASSERT_TRUE(found) << found.error();
  EXPECT_NEAR(geometry::bounding_box(found->contours.front().points_m).size().x(), 0.04, 3e-5);
  fs::remove(scratch("large.png"));
}

TEST(Pictures, AllContoursTogetherAreCentredAndFitted) {
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(220));
  cv::circle(picture, {250, 300}, 120, cv::Scalar(30), -1, cv::LINE_AA);
  cv::rectangle(picture, {500, 250}, {620, 350}, cv::Scalar(30), -1);
  LoadRequest request;
  request.scale.workspace_radius_m = 0.03;
  request.fit_all = true;
  const auto found = contours_of(picture, request);
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 2u);
  double reach_m = 0.0;
  std::vector<Vec2> all;
  for (const auto& line : found->contours) {
    for (const Vec2& point : line.points_m) reach_m = std::max(reach_m, point.norm());
    all.insert(all.end(), line.points_m.begin(), line.points_m.end());
  }
  EXPECT_LT(geometry::bounding_box(all).centre().norm(), 1e-9);
  // The bounding circle is fitted, and its centre is not quite the box's.
  EXPECT_NEAR(reach_m, 0.6 * 0.03, 0.3e-3);
}

TEST(Pictures, PhotographsGiveAPlausibleContourOrAClearRefusal) {
  const fs::path folder = "/usr/share/doc/opencv-doc/examples/data";
  if (!fs::exists(folder)) {
    std::puts("skipped: Debian's package opencv-doc is not installed, so there are no photographs to try");
    GTEST_SKIP();
  }
  int contours = 0;
  int refusals = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if ((kind != ".png" && kind != ".jpg") || fs::file_size(entry.path()) > 600'000) continue;
    const auto found = load_contours(entry.path().string(), {});
    if (!found) {
      ++refusals;
      EXPECT_GT(found.error().size(), 20u) << entry.path();
      continue;
    }
    ++contours;
    const auto& line = found->contours.front();
    EXPECT_TRUE(geometry::all_finite(line.points_m)) << entry.path();
    EXPECT_GE(line.size(), 16u) << entry.path();
    // Ordered: no step is much longer than a pixel, apart from sharpened corners.
    for (std::size_t i = 0; i < line.segments(); ++i) {
      EXPECT_LT((line.end_of(i) - line.start_of(i)).norm(), 60.0 * found->metres_per_pixel) << entry.path();
    }
  }
  std::printf("%d photographs with a contour, %d refused\n", contours, refusals);
  EXPECT_GT(contours, 20);
}

}  // namespace
}  // namespace telekerf::vision
