// SPDX-License-Identifier: Apache-2.0
// Rows with members of several types. A file that is being written holds them as one dataset; the finished one has a
// dataset a member, which every program reads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/recording/h5.h"

namespace telekerf::run_cells {

/// `cells`: rows of the compound `type`, one after the other. Throws h5::Failure.
void write(hid_t where, const std::string& name, hid_t type, const std::vector<std::byte>& cells);
/// Written by write(), or as one dataset. Throws h5::Failure if it is not there or damaged.
std::vector<std::byte> read(hid_t where, const std::string& name, hid_t type);

template <typename Cell>
void add(std::vector<std::byte>& cells, const Cell& cell) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&cell);
  cells.insert(cells.end(), bytes, bytes + sizeof cell);
}

}  // namespace telekerf::run_cells
