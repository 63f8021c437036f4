// SPDX-License-Identifier: Apache-2.0
// Domain type <-> wire type, of everything that crosses the bus. Inside the bus only.
#pragma once

#include "common/bus/wire_blocks.h"
#include "common/bus/wire_messages.h"
