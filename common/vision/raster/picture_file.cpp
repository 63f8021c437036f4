// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/picture_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/vision/files/foreign_file.h"
#include "common/vision/raster/picture_tags.h"

namespace telekerf::vision {
namespace {

constexpr double kMax_px = 128e6;
constexpr double kReducedFrom_px = 24e6;

std::uint32_t big_endian(const unsigned char* b, int bytes) {
  std::uint32_t v = 0;
  for (int i = 0; i < bytes; ++i) v = v << 8 | b[i];
  return v;
}

std::uint32_t little_endian(const unsigned char* b, int bytes) {
  std::uint32_t v = 0;
  for (int i = bytes; i-- > 0;) v = v << 8 | b[i];
  return v;
}

/// Bytes of a file from an offset; zeros beyond its end.
template <std::size_t kBytes>
std::array<unsigned char, kBytes> bytes_at(std::ifstream& file, std::uint64_t offset) {
  std::array<unsigned char, kBytes> out{};
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(out.data()), kBytes);
  return out;
}

struct JpegHead {
  double pixels = 0.0;
  std::uint64_t scan = 0;  ///< where the picture's own data begins; 0: nowhere
};

JpegHead jpeg_head(std::ifstream& file) {
  JpegHead out;
  std::uint64_t at = 2;
  for (int segment = 0; segment < 1000; ++segment) {
    const auto s = bytes_at<9>(file, at);
    if (s[0] != 0xff) break;
    const bool frame = s[1] >= 0xc0 && s[1] <= 0xcf && s[1] != 0xc4 && s[1] != 0xc8 && s[1] != 0xcc;
    if (frame) out.pixels = double(big_endian(&s[5], 2)) * big_endian(&s[7], 2);
    at += 2 + big_endian(&s[2], 2);
    if (s[1] == 0xda) {
      out.scan = at;
      break;
    }
  }
  return out;
}

/// The decoder fills up what is missing with grey and calls it a success. A whole file has an end marker
/// after its data, where no other 0xff 0xd9 can stand.
bool is_cut_jpeg(std::ifstream& file) {
  if (const auto head = bytes_at<2>(file, 0); head[0] != 0xff || head[1] != 0xd8) return false;
  const std::uint64_t scan = jpeg_head(file).scan;
  if (scan == 0) return true;
  file.clear();
  file.seekg(static_cast<std::streamoff>(scan));
  std::array<char, 65536> block;
  bool escape = false;
  while (file.read(block.data(), block.size()), file.gcount() > 0) {
    for (std::streamsize i = 0; i < file.gcount(); ++i) {
      const auto byte = static_cast<unsigned char>(block[i]);
      if (escape && byte == 0xd9) return false;
      escape = byte == 0xff;
    }
  }
  return true;
}

bool is_tiff(std::ifstream& file) {
  const auto head = bytes_at<4>(file, 0);
  return (head[0] == 'I' && head[1] == 'I' && head[2] == '*') ||
         (head[0] == 'M' && head[1] == 'M' && head[3] == '*');
}

/// Decoders talk on stderr; what there is to say is in our own sentence.
class Silence {
 public:
  Silence() : kept_(::dup(STDERR_FILENO)) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
  ~Silence() {
    if (kept_ < 0) return;
    ::dup2(kept_, STDERR_FILENO);
    ::close(kept_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int kept_;
};

/// The first directory of a TIFF file: tags 256 and 257, short or long.
double pixels_in_tiff(std::ifstream& file, bool little) {
  const auto number = [&](const unsigned char* b, int bytes) {
    return little ? little_endian(b, bytes) : big_endian(b, bytes);
  };
  const auto head = bytes_at<8>(file, 0);
  std::uint64_t at = number(&head[4], 4);
  const auto count = bytes_at<2>(file, at);
  at += 2;
  double width = 0.0;
  double height = 0.0;
  for (std::uint32_t i = 0; i < number(count.data(), 2); ++i, at += 12) {
    const auto entry = bytes_at<12>(file, at);
    const double value = number(&entry[2], 2) == 3 ? number(&entry[8], 2) : number(&entry[8], 4);
    if (number(entry.data(), 2) == 256) width = value;
    if (number(entry.data(), 2) == 257) height = value;
  }
  return width * height;
}

/// "P5 width height", blanks and comments between.
double pixels_in_pnm(std::ifstream& file) {
  file.clear();
  file.seekg(2);
  double size[2] = {0.0, 0.0};
  for (double& side : size) {
    while (file >> std::ws && file.peek() == '#') file.ignore(4096, '\n');
    file >> side;
  }
  return file ? size[0] * size[1] : 0.0;
}

/// Width times height from the header of the usual formats, 0 when it cannot be told: read before anything is
/// decoded, so that a few bytes cannot ask for gigabytes.
double pixels_promised(std::ifstream& file) {
  const auto head = bytes_at<64>(file, 0);
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (text.starts_with("\x89P")) return double(big_endian(&head[16], 4)) * big_endian(&head[20], 4);
  if (text.starts_with("BM")) return double(little_endian(&head[18], 4)) * little_endian(&head[22], 4);
  if (text.starts_with("\xff\xd8")) return jpeg_head(file).pixels;
  if (text.starts_with("II*") || text.starts_with("MM")) return pixels_in_tiff(file, text[0] == 'I');
  if (text[0] == 'P' && text[1] >= '1' && text[1] <= '6') return pixels_in_pnm(file);
  if (const auto at = text.find("ihdr");
      at != std::string_view::npos && at + 12 <= text.size()) {  // JPEG 2000
    return double(big_endian(&head[at + 4], 4)) * big_endian(&head[at + 8], 4);
  }
  return 0.0;  // WebP holds 268 Mpx at most; the others are rare
}

bool is_jpeg(std::ifstream& file) {
  const auto head = bytes_at<2>(file, 0);
  return head[0] == 0xff && head[1] == 0xd8;
}

/// Why a file is no picture.
std::string what_it_is(std::ifstream& file) {
  const auto head = bytes_at<64>(file, 0);
  const std::string_view text(reinterpret_cast<const char*>(head.data()),
                              static_cast<std::size_t>(file.gcount()));
  if (std::string known = what_a_file_is(text); !known.empty()) return known;
  if (text.starts_with("\x1F\x8B"))
    return "compressed with gzip; unpack it, or name it .svgz if it is a drawing";
  if (text.find("<svg") != std::string_view::npos || text.starts_with("<?xml"))
    return "an XML file; name it .svg if it is a drawing";
  if (looks_like_dxf(text)) return "a DXF drawing; name it .dxf";
  return "not a picture that can be read, or damaged";
}

/// As EXIF counts: 1 is upright, 6 is to be turned right.
cv::Mat turned(const cv::Mat& image, int orientation) {
  cv::Mat out = image;
  if (orientation >= 5) cv::transpose(image, out);
  const bool mirrored_x = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool mirrored_y = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  cv::Mat upright = out;
  if (mirrored_x && mirrored_y) {
    cv::flip(out, upright, -1);
  } else if (mirrored_x || mirrored_y) {
    cv::flip(out, upright, mirrored_x ? 1 : 0);
  }
  return upright;
}

}  // namespace

tl::expected<Picture, std::string> read_picture(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    return tl::unexpected(fmt::format("{}: cannot be read", path));
  const double pixels = pixels_promised(file);
  if (pixels > kMax_px) {
    return tl::unexpected(
        fmt::format("{}: {:.0f} Mpx is too large (at most {:.0f} Mpx); reduce the picture first", path,
                    pixels / 1e6, kMax_px / 1e6));
  }
  Picture out;
  int flags = cv::IMREAD_UNCHANGED;
  if (pixels > kReducedFrom_px) {
    out.reduction = pixels > 4.0 * kReducedFrom_px ? 4.0 : 2.0;
    // Only JPEG is decoded in a smaller size; what has transparency or 16 bits keeps them.
    if (is_jpeg(file)) flags = out.reduction == 4.0 ? cv::IMREAD_REDUCED_COLOR_4 : cv::IMREAD_REDUCED_COLOR_2;
  }
  if (is_cut_jpeg(file)) return tl::unexpected(fmt::format("{}: the picture's end is missing", path));
  try {
    const Silence silence;
    out.image =
        cv::imread(path, flags == cv::IMREAD_UNCHANGED ? flags : flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const std::exception&) {
    out.image.release();
  }
  if (out.image.empty()) {
    return tl::unexpected(fmt::format("{}: {}", path, what_it_is(file)));
  }
  if (out.reduction > 1.0 && !is_jpeg(file)) {
    const double share = 1.0 / out.reduction;
    cv::resize(out.image, out.image, {}, share, share, cv::INTER_AREA);
  }
  const PictureTags tags = tags_of(file);
  if (!is_tiff(file)) out.image = turned(out.image, tags.orientation);  // that decoder has turned it
  out.dpi = tags.dpi;
  if (static_cast<double>(out.image.total()) > kMax_px) {
    return tl::unexpected(
        fmt::format("{}: {:.0f} Mpx is too large (at most {:.0f} Mpx); reduce the picture first", path,
                    static_cast<double>(out.image.total()) / 1e6, kMax_px / 1e6));
  }
  return out;
}

}  // namespace telekerf::vision
