// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "common/vision/extract.h"

namespace telekerf::vision {
namespace {

constexpr double kLargestPx = 128e6;
constexpr double kReducedFromPx = 24e6;

std::uint32_t big_endian(const unsigned char* b, int bytes) {
  std::uint32_t v = 0;
  for (int i = 0; i < bytes; ++i) v = v << 8 | b[i];
  return v;
}

/// Width times height from a PNG, JPEG or BMP header, 0 when it cannot be told: read before anything is
/// decoded, so that a few bytes cannot ask for gigabytes.
double pixels_promised(std::ifstream& file) {
  std::array<unsigned char, 26> head{};
  if (!file.read(reinterpret_cast<char*>(head.data()), head.size())) return 0.0;
  if (head[0] == 0x89 && head[1] == 'P') return double(big_endian(&head[16], 4)) * big_endian(&head[20], 4);
  if (head[0] == 'B' && head[1] == 'M') {
    const auto little = [&](int at) {
      return double(head[at] | head[at + 1] << 8 | head[at + 2] << 16 | std::uint32_t(head[at + 3]) << 24);
    };
    return little(18) * little(22);
  }
  if (head[0] != 0xff || head[1] != 0xd8) return 0.0;
  std::uint32_t at = 2;
  for (int segment = 0; segment < 1000; ++segment) {
    std::array<unsigned char, 9> s{};
    file.seekg(at);
    if (!file.read(reinterpret_cast<char*>(s.data()), s.size()) || s[0] != 0xff) return 0.0;
    const bool frame = s[1] >= 0xc0 && s[1] <= 0xcf && s[1] != 0xc4 && s[1] != 0xc8 && s[1] != 0xcc;
    if (frame) return double(big_endian(&s[5], 2)) * big_endian(&s[7], 2);
    at += 2 + big_endian(&s[2], 2);
  }
  return 0.0;
}

}  // namespace

tl::expected<Picture, std::string> read_picture(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    return tl::unexpected(fmt::format("{}: cannot be read", path));
  const double pixels = pixels_promised(file);
  if (pixels > kLargestPx) {
    return tl::unexpected(
        fmt::format("{}: {:.0f} Mpx is too large (at most {:.0f} Mpx); reduce the picture first", path,
                    pixels / 1e6, kLargestPx / 1e6));
  }
  Picture out;
  int flags = cv::IMREAD_UNCHANGED;
  if (pixels > kReducedFromPx) {
    out.reduction = pixels > 4.0 * kReducedFromPx ? 4.0 : 2.0;
    flags = out.reduction == 4.0 ? cv::IMREAD_REDUCED_GRAYSCALE_4 : cv::IMREAD_REDUCED_GRAYSCALE_2;
  }
  try {
    out.image = cv::imread(path, flags);
  } catch (const std::exception&) {
    out.image.release();
  }
  if (out.image.empty()) {
    return tl::unexpected(fmt::format("{}: not a picture that can be read, or damaged", path));
  }
  return out;
}

}  // namespace telekerf::vision
