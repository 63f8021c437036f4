// SPDX-License-Identifier: Apache-2.0
// The files of page/, put into the program by the build (embed.cmake makes the source).
#pragma once

#include <span>
#include <string_view>

namespace telekerf::master {

struct PageFile {
  std::string_view name;  ///< "main.js"
  std::string_view text;
};

inline std::string_view type_of(std::string_view name) noexcept {
  const std::string_view ending = name.substr(name.rfind('.') + 1);
  if (ending == "html") return "text/html; charset=utf-8";
  if (ending == "js") return "text/javascript; charset=utf-8";
  if (ending == "css") return "text/css; charset=utf-8";
  return "image/svg+xml";
}

extern const std::span<const PageFile> kPageFiles;

}  // namespace telekerf::master
