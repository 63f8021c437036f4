// SPDX-License-Identifier: Apache-2.0
// Whether a finished file still holds what was written. HDF5's own checksums cover the rows only: a bit that
// has changed in a figure, a size or a name would pass.
#pragma once

#include <cstdint>

#include "common/recording/h5.h"

namespace telekerf::run_content {

/// CRC-32 over all attributes and data sets as they read, in order of their names. Without a person's label,
/// which comes later, and without what ties axes to their data sets. Throws h5::Failure that names a data set
/// and its rows, or an attribute, which cannot be read.
std::uint32_t sum_of(hid_t file);
/// Attribute of the root; the last that is written.
void write_sum(hid_t file);
/// Throws h5::Failure: it is not there, or is another one than that of the contents.
void check_sum(hid_t file);

}  // namespace telekerf::run_content
