// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-inspect; each declares its options and, when chosen, sets the action.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::inspect {

}  // namespace telekerf::inspect
