// SPDX-License-Identifier: Apache-2.0
// The one place that says which domain type travels as which wire type, on which topic, with which quality of
// service. Inside the bus only.
#pragma once

#if __has_include(<telekerfPubSubTypes.hpp>)
#include <telekerfPubSubTypes.hpp>
#else
#include <telekerfPubSubTypes.h>
#endif

#include <cstddef>

#include "common/protocol/messages.h"
#include "common/protocol/site.h"

namespace telekerf::bus {

/// Quality of service by intent (qos.h gives each its numbers).
enum class Intent {
  kStream,   ///< newest matters, a lost one is not missed: best effort, nothing kept
  kLatched,  ///< whoever comes late gets the last one: reliable, transient local, may be large
  kEvent,    ///< each one matters, soon: reliable, volatile
  kStop,     ///< must arrive, at once, and at whoever comes later: reliable, transient local
  kSlow,     ///< numbers for people: best effort
};

/// A best-effort reader of DDS drops whatever a younger sample of the same writer has overtaken. Blocks that
/// come late but in time for the play-out are still good, so a stream's samples take turns on this many
/// writers: only what is overtaken by as many blocks is lost.
inline constexpr int kStreamLanes = 8;

/// What follows from the intent alone.
template <class WireType, Intent kHow>
struct TopicOf {
  using Type = WireType;
  static constexpr Intent kIntent = kHow;
  static constexpr int kLanes = kHow == Intent::kStream ? kStreamLanes : 1;
  /// Samples that wait to be taken.
  static constexpr std::size_t kRing = kHow == Intent::kLatched ? 8 : 256;
  /// Of the first of the kLanes writers that a process may have of the topic (streams only, see site.h; the
  /// middleware counts otherwise).
  static constexpr int kEntity = 0;
  /// The role that alone is heard; null: whoever has announced itself in the cell.
  static constexpr const char* kFrom = nullptr;
};

template <class T>
struct Topic;

template <>
struct Topic<CommandBlock> : TopicOf<wire::CommandBlockPubSubType, Intent::kStream> {
  static constexpr const char* kName = "telekerf/command";
  static constexpr int kEntity = kStreamEntity << 8 | 0x10;
  static constexpr const char* kFrom = "master";
};
template <>
struct Topic<StateBlock> : TopicOf<wire::StateBlockPubSubType, Intent::kStream> {
  static constexpr const char* kName = "telekerf/state";
  static constexpr int kEntity = kStreamEntity << 8 | 0x20;
  static constexpr const char* kFrom = "slave";
};
template <>
struct Topic<ContourMessage> : TopicOf<wire::ContourPubSubType, Intent::kLatched> {
  static constexpr const char* kName = "telekerf/contour";
  static constexpr const char* kFrom = "vision";
};
template <>
struct Topic<PreviewMessage> : TopicOf<wire::PreviewPubSubType, Intent::kLatched> {
  static constexpr const char* kName = "telekerf/preview";
  static constexpr const char* kFrom = "vision";
};
template <>
struct Topic<EventMessage> : TopicOf<wire::EventPubSubType, Intent::kEvent> {
  static constexpr const char* kName = "telekerf/event";
};
template <>
struct Topic<StopMessage> : TopicOf<wire::StopPubSubType, Intent::kStop> {
  static constexpr const char* kName = "telekerf/stop";
};
template <>
struct Topic<TelemetryMessage> : TopicOf<wire::TelemetryPubSubType, Intent::kSlow> {
  static constexpr const char* kName = "telekerf/telemetry";
};

}  // namespace telekerf::bus
