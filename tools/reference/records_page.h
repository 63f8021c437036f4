// SPDX-License-Identifier: Apache-2.0
// The page of records, out of the records' columns.
#pragma once

#include <string>

namespace telekerf::reference {

std::string records_page();

}  // namespace telekerf::reference
