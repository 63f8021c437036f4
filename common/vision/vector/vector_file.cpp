// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/vector_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <utility>

#include "common/vision/files/foreign_file.h"
#include "common/vision/vector/dxf/document.h"
#include "common/vision/vector/svg/document.h"
#include "common/vision/vector/text_encoding.h"

namespace telekerf::vision {
namespace {

std::string extension_of(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

/// What a file that could not be read is, where its name says something else; empty: not known.
std::string kind_of(const std::string& bytes, bool named_dxf) {
  const std::string text = utf8_of(bytes.substr(0, 4096));
  if (text.starts_with("\x89PNG")) return "a PNG picture; name it .png";
  if (text.starts_with("\xFF\xD8\xFF")) return "a JPEG picture; name it .jpg";
  if (named_dxf && text.find("<svg") != std::string::npos) return "an SVG drawing; name it .svg";
  if (!named_dxf && looks_like_dxf(text)) return "a DXF drawing; name it .dxf";
  std::string known = what_a_file_is(bytes.substr(0, 64));
  return known.empty() ? what_a_file_is(text) : known;
}

}  // namespace

bool is_vector_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".svg" || extension == ".svgz" || extension == ".dxf";
}

tl::expected<VectorDrawing, std::string> read_vector_file(const std::string& path,
                                                          const VectorRequest& request,
                                                          const VectorLimits& limits) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return tl::unexpected(fmt::format("{}: cannot be read", path));
  if (bytes > limits.max_bytes) {
    return tl::unexpected(fmt::format("{}: larger than {} MB", path, limits.max_bytes / 1000000));
  }
  std::string text(bytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<std::size_t>(file.gcount()));
  auto plain = unzipped(std::move(text), limits.max_bytes);
  if (!plain) return tl::unexpected(fmt::format("{}: {}", path, plain.error()));
  const bool is_dxf = extension_of(path) == ".dxf";
  auto out = is_dxf ? read_dxf(*plain, limits, request) : read_svg(*plain, limits, request);
  if (out) return out;
  std::string known = kind_of(*plain, is_dxf);
  return tl::unexpected(fmt::format("{}: {}", path, known.empty() ? out.error() : known));
}

}  // namespace telekerf::vision
