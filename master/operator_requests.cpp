// SPDX-License-Identifier: Apache-2.0
#include "master/operator_requests.h"

namespace telekerf::master {

bool OperatorRequests::hear(std::span<const EventMessage> events, bool beam_on) noexcept {
  bool rescale = false;
  for (const EventMessage& event : events) {
    if (event.kind == EventMessage::Kind::kEngage) engage_ = true;
    if (event.kind == EventMessage::Kind::kDisengage) engage_ = false;
    if (event.kind == EventMessage::Kind::kSetBeta && !beam_on && event.value >= kSmallestBeta &&
        event.value <= kLargestBeta && event.value != wanted_beta_.load()) {
      wanted_beta_.store(event.value);
      rescale = true;
    }
  }
  return rescale;
}

}  // namespace telekerf::master
