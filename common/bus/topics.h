// SPDX-License-Identifier: Apache-2.0
// The one place that says which domain type travels as which wire type, on which topic, with which quality of
// service. Inside the bus only.
#pragma once

#include <telekerfPubSubTypes.h>

#include <cstddef>

#include "common/protocol/messages.h"
#include "common/protocol/site.h"

namespace telekerf::bus {

/// Quality of service by intent (qos.h gives each its numbers).
enum class Intent {
  kStream,   ///< newest matters, a lost one is not missed: best effort, nothing kept
  kLatched,  ///< whoever comes late gets the last one: reliable, transient local, may be large
  kEvent,    ///< each one matters, soon: reliable, volatile
  kSlow,     ///< numbers for people: best effort
};

/// A best-effort reader of DDS drops whatever a younger sample of the same writer has overtaken. Blocks that
/// come late but in time for the play-out are still good, so a stream's samples take turns on this many
/// writers: only what is overtaken by as many blocks is lost.
inline constexpr int kStreamLanes = 8;

/// kEntity: id of the first of the kLanes writers that a process may have of the topic (streams only, see
/// site.h; the middleware counts otherwise).
template <class T>
struct Topic;

template <>
struct Topic<CommandBlock> {
  using Type = wire::CommandBlockPubSubType;
  static constexpr const char* kName = "telekerf/command";
  static constexpr Intent kIntent = Intent::kStream;
  static constexpr int kEntity = kStreamEntity << 8 | 0x10;
  static constexpr int kLanes = kStreamLanes;
  static constexpr std::size_t kRing = 256;  ///< samples that wait to be taken
};

template <>
struct Topic<StateBlock> {
  using Type = wire::StateBlockPubSubType;
  static constexpr const char* kName = "telekerf/state";
  static constexpr Intent kIntent = Intent::kStream;
  static constexpr int kEntity = kStreamEntity << 8 | 0x20;
  static constexpr int kLanes = kStreamLanes;
  static constexpr std::size_t kRing = 256;
};

template <>
struct Topic<ContourMessage> {
  using Type = wire::ContourPubSubType;
  static constexpr const char* kName = "telekerf/contour";
  static constexpr Intent kIntent = Intent::kLatched;
  static constexpr int kEntity = 0;
  static constexpr int kLanes = 1;
  static constexpr std::size_t kRing = 8;
};

template <>
struct Topic<EventMessage> {
  using Type = wire::EventPubSubType;
  static constexpr const char* kName = "telekerf/event";
  static constexpr Intent kIntent = Intent::kEvent;
  static constexpr int kEntity = 0;
  static constexpr int kLanes = 1;
  static constexpr std::size_t kRing = 256;
};

template <>
struct Topic<TelemetryMessage> {
  using Type = wire::TelemetryPubSubType;
  static constexpr const char* kName = "telekerf/telemetry";
  static constexpr Intent kIntent = Intent::kSlow;
  static constexpr int kEntity = 0;
  static constexpr int kLanes = 1;
  static constexpr std::size_t kRing = 256;
};

}  // namespace telekerf::bus
