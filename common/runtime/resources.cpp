// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/resources.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;

fs::path program_beside(const std::string& name) {
  return fs::read_symlink("/proc/self/exe").parent_path() / name;
}

fs::path data_folder() {
  if (const char* set = std::getenv("TELEKERF_DATA")) return set;
  return program_beside("").parent_path().parent_path() / "share" / "telekerf";
}

std::vector<std::string> shipped_names(const std::string& kind, const std::string& extension) {
  std::vector<std::string> names;
  std::error_code ignored;  // a missing folder ships nothing
  for (const auto& entry : fs::directory_iterator(data_folder() / kind, ignored)) {
    if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string complaint_about_resource(const std::string& kind, const std::string& name,
                                     const std::string& extension) {
  std::error_code ignored;
  if (fs::exists(name, ignored)) return "";
  if (name.find('/') == std::string::npos &&
      fs::is_regular_file(data_folder() / kind / (name + extension), ignored))
    return "";
  return fmt::format("is neither a file nor one of the shipped {}: {}", kind,
                     fmt::join(shipped_names(kind, extension), ", "));
}

fs::path find_resource(const std::string& kind, const std::string& name, const std::string& extension) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return name;
  fs::path shipped = data_folder() / kind / (name + extension);
  if (name.find('/') == std::string::npos && fs::is_regular_file(shipped, ignored)) return shipped;
  const std::string wrong = complaint_about_resource(kind, name, extension);
  throw input_error(fmt::format("'{}' {}", name, wrong.empty() ? "is no file" : wrong));
}

}  // namespace telekerf
