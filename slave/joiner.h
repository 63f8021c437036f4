// SPDX-License-Identifier: Apache-2.0
// The slave's names for motions and how they are joined.
#pragma once

#include "common/bus/messages.h"
#include "common/control/joiner.h"

namespace telekerf::slave {

using control::advanced;
using control::JoinerSettings;
using control::Motion;
using control::ReferenceJoiner;

}  // namespace telekerf::slave
