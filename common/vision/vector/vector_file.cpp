// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/vector_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <utility>

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
  auto out =
      extension_of(path) == ".dxf" ? read_dxf(*plain, limits, request) : read_svg(*plain, limits, request);
  if (!out) return tl::unexpected(fmt::format("{}: {}", path, out.error()));
  return out;
}

}  // namespace telekerf::vision
