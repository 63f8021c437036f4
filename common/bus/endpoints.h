// SPDX-License-Identifier: Apache-2.0
// Typed readers and writers. CommandBlock and StateBlock are best-effort streams, ContourMessage is latched
// and reliable as PreviewMessage, EventMessage reliable, TelemetryMessage best effort (topics.h).
#pragma once

#include "common/bus/reader.h"
#include "common/bus/writer.h"
