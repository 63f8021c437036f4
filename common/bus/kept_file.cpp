// SPDX-License-Identifier: Apache-2.0
#include "common/bus/kept_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

/// Empty: not set.
std::filesystem::path from_environment(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT
  return value == nullptr ? "" : value;
}

std::filesystem::path state_folder() {
  if (const auto state = from_environment("XDG_STATE_HOME"); !state.empty()) return state;
  const auto home = from_environment("HOME");
  return home.empty() ? home : home / ".local" / "state";
}

}  // namespace

TextForm kept_file_form() {
  return {.form = "auto|off|FILE", .complaint = [](const std::string& text) {
            return text.empty() ? std::string("say auto, off or a file") : std::string();
          }};
}

std::string path_of(const KeptFile& file, const BusSettings& bus) {
  if (file.chosen == "off") return {};
  if (file.chosen != "auto") return file.chosen;
  const std::filesystem::path folder = state_folder();
  if (folder.empty())
    throw environment_error(fmt::format(
        "{} auto: neither HOME nor XDG_STATE_HOME says where {} could be kept over a restart; name a file, or say {} off",
        file.flag, file.what, file.flag));
  std::string cell = bus.cell;
  std::replace(cell.begin(), cell.end(), '/', '_');
  return folder / "telekerf" / fmt::format("{}-{}-{}{}", bus.domain, cell, bus.role, file.ending);
}

}  // namespace telekerf
