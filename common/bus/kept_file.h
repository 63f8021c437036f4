// SPDX-License-Identifier: Apache-2.0
// Where a process keeps what shall survive its restart: a file named after domain, cell and role in the user's state
// folder, unless the user has named another one.
#pragma once

#include <string>

#include "common/bus/bus.h"
#include "common/runtime/settings.h"

namespace telekerf {

/// Of a setting that says where: auto|off|FILE.
TextForm kept_file_form();
struct KeptFile {
  std::string chosen;  ///< the setting's value
  std::string flag;    ///< its name on the command line, "--stop-file"
  std::string what;    ///< is kept, "an emergency stop"
  std::string ending;  ///< of the file that `auto` means, ".stop"
};
/// Empty: nowhere. Throws StartupError: nobody knows where.
std::string path_of(const KeptFile& file, const BusSettings& bus);

}  // namespace telekerf
