// SPDX-License-Identifier: Apache-2.0
#include "common/recording/record_flags.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>

#include "common/recording/run_record.h"
#include "common/runtime/results.h"

namespace telekerf {

void RecordFlags::add_parameters(Settings& settings) {
  settings
      .add("record", record, TextForm{.form = "FOLDER|off", .complaint = [](const std::string&) { return ""; }},
           "for the record of the run; off: none; not said: a folder of its own below out/")
      .empty_is_said();
}

void RecordFlags::validate(const std::string& role) const {
  if (named()) refuse_record_folder("--record", record, role);
}

std::filesystem::path RecordFlags::folder(const std::string& role) const {
  std::filesystem::path folder = record;
  if (!named()) {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    folder = fmt::format("out/{:%Y%m%d-%H%M%S}-{}-{}", fmt::localtime(now), role, ::getpid());
  }
  make_folder("--record", folder);
  return folder;
}

}  // namespace telekerf
