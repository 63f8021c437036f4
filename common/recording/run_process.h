// SPDX-License-Identifier: Apache-2.0
// Which process writes a recording, and whether it still does.
#pragma once

#include <hdf5.h>

#include <optional>

namespace telekerf {

/// This one, as attributes of the file.
void write_process(hid_t file);
/// The number of the process that still writes the file on this computer; none: it is gone, or ran elsewhere.
std::optional<int> writing_process(hid_t file);

}  // namespace telekerf
