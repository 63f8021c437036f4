// SPDX-License-Identifier: Apache-2.0
// Where a process records into: the setting `record`, which every process with a run has.
#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/settings.h"

namespace telekerf {

struct RecordFlags {
  std::string record;  ///< a folder; empty: one of its own below out/; "off": nothing is recorded

  void add_parameters(Settings& settings);
  bool off() const { return record == "off"; }
  /// The user has named a folder: results go there as text as well.
  bool named() const { return !record.empty() && !off(); }
  /// Refuses a folder that holds the record of another run of `role`, or cannot be written to.
  void validate(const std::string& role) const;
  /// Makes the folder. Throws StartupError.
  std::filesystem::path folder(const std::string& role) const;
};

}  // namespace telekerf
