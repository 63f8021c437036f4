// SPDX-License-Identifier: Apache-2.0
// The slave's names for motions and how they are joined.
#pragma once

#include "common/control/bumpless_transfer.h"
#include "common/protocol/messages.h"

namespace telekerf::slave {

using control::advanced;
using control::BumplessTransfer;
using control::BumplessTransferSettings;
using control::KinematicState;

}  // namespace telekerf::slave
