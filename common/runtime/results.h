// SPDX-License-Identifier: Apache-2.0
// What a command leaves: a folder, text and JSON in it. Failures are Refusals that name the file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace telekerf {

/// Refuses a folder that `option` names if it cannot be written to or made; makes none.
void refuse_unwritable(const std::string& option, const std::filesystem::path& folder);

/// Makes the folder that `option` names, unless it is there.
void make_folder(const std::string& option, const std::filesystem::path& folder);

/// Where results for `file` are written until they are whole: beside it, or beside what it is a link to; what is no
/// plain file (a device, a pipe) is written straight away, and is its own draft.
struct OutputPlace {
  std::filesystem::path draft;
  std::filesystem::path file;
  bool straight() const { return draft == file; }
};
OutputPlace output_place(const std::filesystem::path& file);

/// Written beside and renamed, so that nothing half-written is ever found under the final name.
void write_atomically(const std::filesystem::path& file, const std::string& text);

/// Bytes that are no UTF-8, as a file's name may hold, are replaced.
template <typename Json>
std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

template <typename Json>
void write_json(const std::filesystem::path& file, const Json& json) {
  write_atomically(file, json_text(json) + "\n");
}

}  // namespace telekerf
