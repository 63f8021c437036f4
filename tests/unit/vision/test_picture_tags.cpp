// SPDX-License-Identifier: Apache-2.0
// Which way up a picture is, how large a scan is, and what a file is that is no picture.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/vision/load.h"
#include "common/vision/raster/picture_file.h"

namespace telekerf::vision {
namespace {

std::string written(const std::string& name, const std::string& bytes) {
  const auto file =
      std::filesystem::temp_directory_path() / ("telekerf-tags-" + std::to_string(::getpid()) + name);
  std::ofstream(file, std::ios::binary) << bytes;
  return file.string();
}

std::string encoded(const cv::Mat& image, const std::string& extension) {
  std::vector<unsigned char> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

/// An EXIF block of one tag, put behind the start of a JPEG file.
std::string with_orientation(std::string jpeg, int orientation) {
  const std::string tiff = std::string("MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0", 19) +
                           static_cast<char>(orientation) + std::string("\0\0\0\0\0\0", 6);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const std::size_t size = body.size() + 2;
  std::string segment = "\xFF\xE1";
  segment += static_cast<char>(size >> 8U);
  segment += static_cast<char>(size & 0xFFU);
  return jpeg.insert(2, segment + body);
}

/// A TIFF file of grey pixels, 8 or 16 bits, that states its orientation.
std::string tiff_of(const cv::Mat& image, int orientation) {
  const auto bytes = [](std::uint32_t value, int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += static_cast<char>(value >> 8 * i & 0xFFU);
    return out;
  };
  const auto size = static_cast<std::uint32_t>(image.total() * image.elemSize());
  std::string out = "II*" + std::string(1, '\0') + bytes(8 + size, 4);
  out.append(reinterpret_cast<const char*>(image.data), size);
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> tags{
      {256, image.cols},  {257, image.rows}, {258, image.depth() == CV_16U ? 16 : 8},
      {259, 1},           {262, 1},          {273, 8},
      {274, orientation}, {277, 1},          {278, image.rows},
      {279, size}};
  out += bytes(static_cast<std::uint32_t>(tags.size()), 2);
  for (const auto& [tag, value] : tags) out += bytes(tag, 2) + bytes(4, 2) + bytes(1, 4) + bytes(value, 4);
  return out + bytes(0, 4);
}

TEST(PictureTags, EveryOrientationComesUpright) {
  // Dark in its upper left part: as it should be seen.
  cv::Mat upright(32, 48, CV_8UC1, cv::Scalar(250));
  upright(cv::Rect(0, 0, 16, 8)).setTo(10);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    cv::Mat stored = upright.clone();
    // The way back of what the reader does.
    if (orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7)
      cv::flip(stored, stored, 1);
    if (orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8)
      cv::flip(stored, stored, 0);
    if (orientation >= 5) cv::transpose(stored, stored);
    cv::Mat deep;
    stored.convertTo(deep, CV_16U, 257.0);
    for (const auto& [ending, bytes] :
         {std::pair(".jpg", with_orientation(encoded(stored, ".jpg"), orientation)),
          {".tif", tiff_of(stored, orientation)},
          {".tif", tiff_of(deep, orientation)}}) {
      const std::string file = written(ending, bytes);
      const auto picture = read_picture(file);
      std::filesystem::remove(file);
      ASSERT_TRUE(picture) << picture.error();
      cv::Mat seen;
      picture->image.convertTo(seen, CV_8U, picture->image.depth() == CV_16U ? 1.0 / 257.0 : 1.0);
      cv::extractChannel(seen, seen, 0);
      ASSERT_EQ(seen.size(), upright.size()) << ending << orientation;
      EXPECT_LT(seen.at<unsigned char>(3, 4), 60) << ending << orientation;
      EXPECT_GT(seen.at<unsigned char>(28, 40), 200) << ending << orientation;
    }
  }
}

TEST(PictureTags, ALargePhotographComesUprightToo) {
  // 25 million pixels: read at half its size. Turned as 6 says: what is stored at the left is seen at the
  // top.
  cv::Mat stored(4200, 6000, CV_8UC1, cv::Scalar(250));
  stored(cv::Rect(0, 2100, 1500, 2100)).setTo(10);
  const std::string file = written(".jpg", with_orientation(encoded(stored, ".jpg"), 6));
  const auto picture = read_picture(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(picture) << picture.error();
  cv::Mat seen;
  cv::extractChannel(picture->image, seen, 0);
  EXPECT_EQ(seen.size(), cv::Size(2100, 3000));
  EXPECT_LT(seen.at<unsigned char>(300, 300), 60) << "upper left";
  EXPECT_GT(seen.at<unsigned char>(300, 1500), 200) << "upper right";
  EXPECT_GT(seen.at<unsigned char>(2700, 300), 200) << "lower left";
}

TEST(PictureTags, SixteenBitsAndTransparencyAreSeen) {
  // A disc, dark on a transparent ground of the same grey: only its alpha tells it; or a disc that 8 bits
  // would lose.
  for (const int type : {CV_8UC4, CV_16UC4}) {
    const double full = type == CV_8UC4 ? 255.0 : 65535.0;
    cv::Mat image(120, 160, type, cv::Scalar(0.1 * full, 0.1 * full, 0.1 * full, 0.0));
    cv::circle(image, {80, 60}, 40, cv::Scalar(0.1 * full, 0.1 * full, 0.1 * full, full), cv::FILLED);
    const std::string file = written(".png", encoded(image, ".png"));
    const auto loaded = load_contours(file, {});
    std::filesystem::remove(file);
    ASSERT_TRUE(loaded) << loaded.error();
    ASSERT_EQ(loaded->contours.size(), 1u) << type;
    const auto size = geometry::bounding_box(loaded->contours[0].points_m).size();
    EXPECT_NEAR(size.x() / loaded->metres_per_pixel, 81.0, 1.5) << type;
  }
}

/// A PNG file that states its pixels a metre.
std::string with_density(std::string png, unsigned pixels_per_metre) {
  std::string chunk("\0\0\0\x09pHYs", 8);
  for (int axis = 0; axis < 2; ++axis) {
    for (int shift = 24; shift >= 0; shift -= 8)
      chunk += static_cast<char>(pixels_per_metre >> shift & 0xFFU);
  }
  chunk += '\x01';
  unsigned crc = 0xFFFFFFFFU;
  for (std::size_t i = 4; i < chunk.size(); ++i) {
    crc ^= static_cast<unsigned char>(chunk[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xEDB88320U : crc >> 1U;
  }
  crc = ~crc;
  for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(crc >> shift & 0xFFU);
  return png.insert(33, chunk);
}

TEST(PictureTags, AScanHasItsTrueSize) {
  cv::Mat image(200, 300, CV_8UC1, cv::Scalar(250));
  image(cv::Rect(100, 50, 100, 100)).setTo(10);
  const std::string png = encoded(image, ".png");
  for (const auto& [density, side_mm] :
       {std::pair(11811U, 100 * 25.4 / 300.0), {23622U, 100 * 25.4 / 600.0}}) {
    const std::string file = written(".png", with_density(png, density));
    const auto loaded = load_contours(file, {});
    std::filesystem::remove(file);
    ASSERT_TRUE(loaded) << loaded.error();
    const auto size = geometry::bounding_box(loaded->contours.at(0).points_m).size();
    EXPECT_NEAR(1e3 * size.x(), side_mm, 0.03);
    EXPECT_NE(loaded->size_from.find("inch"), std::string::npos);
  }
  // What a screen has says nothing, and what is asked for counts first.
  for (const unsigned density : {2835U, 3780U}) {
    const std::string file = written(".png", with_density(png, density));
    EXPECT_FALSE(read_picture(file)->dpi);
    std::filesystem::remove(file);
  }
}

}  // namespace
}  // namespace telekerf::vision
