// SPDX-License-Identifier: Apache-2.0
// Everything that the processes say to each other, as domain types: the nodes and the simulation in virtual
// time know these only.
#pragma once

#include "common/protocol/blocks.h"
#include "common/protocol/contour.h"
#include "common/protocol/events.h"
#include "common/protocol/presence.h"
#include "common/protocol/preview.h"
#include "common/protocol/received.h"
#include "common/protocol/stop.h"
