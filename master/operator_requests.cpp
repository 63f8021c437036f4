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
    if (now.stream_changes && event.kind == EventMessage::Kind::kEngage) {
      heard.refusal = "refused: law, estimator or codec are just being changed; engage when they are";
      continue;
    }
    if (event.kind == EventMessage::Kind::kEngage) {
      engage_ = by_event_ = true;
      waited_s_ = gone_s_ = 0.0;
    }
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

const char* OperatorRequests::wait(std::int64_t now_ns, const Waiting& now) noexcept {
  constexpr double kPatience_s = 5.0, kGone_s = 0.5;
  const double passed_s = stepped_ns_ == 0 ? 0.0 : static_cast<double>(now_ns - stepped_ns_) * 1e-9;
  stepped_ns_ = now_ns;
  if (!engage_ || !by_event_ || now.led) return nullptr;
  if (now.guiding) waited_s_ += passed_s;
  gone_s_ = now.slave_gone ? gone_s_ + passed_s : 0.0;
  const char* over = nullptr;
  if (gone_s_ > kGone_s) over = "not engaged: the slave is not heard any more; engage when it is there";
  if (passed_s > now.most_s) over = "not engaged: the master's process stood still meanwhile; engage anew";
  if (waited_s_ > kPatience_s) over = "not engaged: the slave was not ready within 5 s; engage when it is";
  engage_ = over == nullptr;
  return over;
}

}  // namespace telekerf::master
