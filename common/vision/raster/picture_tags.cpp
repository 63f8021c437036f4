// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/picture_tags.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace telekerf::vision {
namespace {

constexpr std::size_t kMaxTags = 256 * 1024;  ///< bytes of a block that are looked at

std::string read_at(std::ifstream& file, std::uint64_t offset, std::size_t bytes) {
  std::string out(bytes, '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(out.data(), static_cast<std::streamsize>(bytes));
  out.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return out;
}

std::uint32_t number(std::string_view text, std::size_t at, std::size_t bytes, bool little) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::size_t k = at + (little ? bytes - 1 - i : i);
    v = v << 8U | (k < text.size() ? static_cast<unsigned char>(text[k]) : 0U);
  }
  return v;
}

struct Found {
  int orientation = 1;
  double x_dpi = 0.0;
  double y_dpi = 0.0;
  bool camera = false;  ///< it tells of an exposure
};

/// The first directory of a TIFF structure, and whether there is one of an exposure.
void read_tiff(std::string_view tiff, Found& out) {
  if (tiff.size() < 8 || (!tiff.starts_with("II") && !tiff.starts_with("MM"))) return;
  const bool little = tiff[0] == 'I';
  const std::size_t directory = number(tiff, 4, 4, little);
  const std::size_t count = std::min<std::size_t>(number(tiff, directory, 2, little), 500);
  double unit = 1.0;  // an inch
  double x = 0.0;
  double y = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    if (at + 12 > tiff.size()) break;
    const auto rational = [&] {
      const std::size_t where = number(tiff, at + 8, 4, little);
      const double below = number(tiff, where + 4, 4, little);
      return below > 0.0 ? number(tiff, where, 4, little) / below : 0.0;
    };
    switch (number(tiff, at, 2, little)) {
      case 274:
        out.orientation = static_cast<int>(number(tiff, at + 8, 2, little));
        break;
      case 282:
        x = rational();
        break;
      case 283:
        y = rational();
        break;
      case 296:
        unit = number(tiff, at + 8, 2, little) == 3 ? 2.54 : number(tiff, at + 8, 2, little) == 1 ? 0.0 : 1.0;
        break;
      case 34665: {
        const std::size_t exif = number(tiff, at + 8, 4, little);
        const std::size_t entries = std::min<std::size_t>(number(tiff, exif, 2, little), 500);
        for (std::size_t k = 0; k < entries; ++k) {
          const std::uint32_t tag = number(tiff, exif + 2 + 12 * k, 2, little);
          if (tag == 33434 || tag == 33437) out.camera = true;
        }
        break;
      }
      default:
        break;
    }
  }
  if (x * unit > 0.0) out.x_dpi = x * unit;
  if (y * unit > 0.0) out.y_dpi = y * unit;
}

void read_jpeg(std::ifstream& file, Found& out) {
  std::uint64_t at = 2;
  for (int segment = 0; segment < 1000; ++segment) {
    const std::string head = read_at(file, at, 4);
    if (head.size() < 4 || head[0] != '\xff' || head[1] == '\xda') return;
    const std::size_t size = number(head, 2, 2, false);
    if (head[1] == '\xe0' || head[1] == '\xe1') {
      const std::string body = read_at(file, at + 4, std::min(size, kMaxTags));
      if (body.starts_with("Exif"))
        read_tiff(std::string_view(body).substr(std::min<std::size_t>(6, body.size())), out);
      if (body.starts_with("JFIF") && body.size() > 11 && body[7] != 0) {
        const double unit = body[7] == 2 ? 2.54 : 1.0;
        out.x_dpi = unit * number(body, 8, 2, false);
        out.y_dpi = unit * number(body, 10, 2, false);
      }
    }
    at += 2 + size;
  }
}

void read_png(std::ifstream& file, Found& out) {
  std::uint64_t at = 8;
  for (int chunk = 0; chunk < 100000; ++chunk) {
    const std::string head = read_at(file, at, 8);
    if (head.size() < 8) return;
    const std::size_t size = number(head, 0, 4, false);
    const std::string_view kind = std::string_view(head).substr(4);
    if (kind == "eXIf") read_tiff(read_at(file, at + 8, std::min(size, kMaxTags)), out);
    if (kind == "pHYs") {
      const std::string body = read_at(file, at + 8, 9);
      if (body.size() == 9 && body[8] == 1) {
        out.x_dpi = 0.0254 * number(body, 0, 4, false);
        out.y_dpi = 0.0254 * number(body, 4, 4, false);
      }
    }
    at += 12 + static_cast<std::uint64_t>(size);
  }
}

void read_webp(std::ifstream& file, Found& out) {
  std::uint64_t at = 12;
  for (int chunk = 0; chunk < 1000; ++chunk) {
    const std::string head = read_at(file, at, 8);
    if (head.size() < 8) return;
    const std::size_t size = number(head, 4, 4, true);
    if (head.starts_with("EXIF")) {
      std::string body = read_at(file, at + 8, std::min(size, kMaxTags));
      if (body.starts_with("Exif")) body.erase(0, 6);
      read_tiff(body, out);
    }
    at += 8 + static_cast<std::uint64_t>(size + size % 2);
  }
}

}  // namespace

PictureTags tags_of(std::ifstream& file) {
  const std::string head = read_at(file, 0, 12);
  Found found;
  if (head.starts_with("\xff\xd8")) read_jpeg(file, found);
  if (head.starts_with("\x89PNG")) read_png(file, found);
  if (head.starts_with("RIFF") && head.substr(std::min<std::size_t>(8, head.size())) == "WEBP")
    read_webp(file, found);
  if (head.starts_with("II*") || (head.starts_with("MM") && head[2] == 0)) {
    // The directory may stand at the end; its offset is what counts.
    const bool little = head[0] == 'I';
    const std::uint32_t directory = number(head, 4, 4, little);
    std::string tiff = read_at(file, 0, std::min<std::size_t>(directory + 65536ULL, 512ULL << 20U));
    read_tiff(tiff, found);
  }
  PictureTags out;
  if (found.orientation >= 1 && found.orientation <= 8) out.orientation = found.orientation;
  constexpr double kOfScreens = 100.0;
  const bool square = std::abs(found.x_dpi - found.y_dpi) <= 0.01 * found.x_dpi;
  if (square && !found.camera && found.x_dpi > kOfScreens && found.x_dpi < 20000.0)
    out.dpi = std::round(found.x_dpi * 10.0) / 10.0;
  return out;
}

}  // namespace telekerf::vision
