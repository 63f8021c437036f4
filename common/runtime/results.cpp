// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/results.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "common/runtime/refusal.h"

namespace telekerf {
namespace fs = std::filesystem;

void make_out_folder(const fs::path& folder) {
  std::error_code failed;
  if (folder.empty()) throw Refusal("--out is empty: name a folder for the results");
  fs::create_directories(folder, failed);
  if (failed) throw Refusal(fmt::format("--out {}: {}; name another folder", folder.string(), failed.message()));
  if (!fs::is_directory(folder)) throw Refusal(fmt::format("--out {}: is no folder", folder.string()));
}

void write_whole(const fs::path& file, const std::string& text) {
  std::error_code failed;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), failed);
  const fs::path draft = file.string() + ".part";
  {
    std::ofstream out(draft, std::ios::binary);
    out << text;
    if (!out.flush()) throw Refusal(fmt::format("{}: cannot be written; is the folder writable?", file.string()));
  }
  fs::rename(draft, file, failed);
  if (!failed) return;
  std::error_code ignored;
  fs::remove(draft, ignored);
  throw Refusal(fmt::format("{}: {}", file.string(), failed.message()));
}

}  // namespace telekerf
