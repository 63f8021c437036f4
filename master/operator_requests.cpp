// SPDX-License-Identifier: Apache-2.0
#include "master/operator_requests.h"

namespace telekerf::master {

OperatorRequests::Heard OperatorRequests::hear(std::span<const EventMessage> events,
                                               const Situation& now) noexcept {
  Heard heard;
  for (const EventMessage& event : events) {
    const bool scale = event.kind == EventMessage::Kind::kSetBeta;
    if (now.stopped && (scale || event.kind == EventMessage::Kind::kEngage)) {
      heard.refusal = "refused while stopped: neither engaged nor scaled before the stop is cleared";
      continue;
    }
    if (event.kind == EventMessage::Kind::kEngage) engage_ = true;
    if (event.kind == EventMessage::Kind::kDisengage) engage_ = false;
    if (!scale || event.value == wanted_beta_.load()) continue;
    if (!(event.value >= kSmallestBeta && event.value <= kLargestBeta)) {
      heard.refusal = "refused: that scale is out of bounds";
    } else if (now.beam_on) {
      heard.refusal = "refused: no other scale while the beam is on; disengage first";
    } else {
      wanted_beta_.store(event.value);
      heard.rescale = true;
    }
  }
  return heard;
}

}  // namespace telekerf::master
