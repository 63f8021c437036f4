// SPDX-License-Identifier: Apache-2.0
#include "common/bus/qos.h"

namespace telekerf::bus {
namespace {

namespace dds = middleware::dds;
namespace rtps = middleware::rtps;

constexpr int kEvents = 256;  // kept for a reader that is behind
constexpr int kStops = 32;    // kept for whoever comes later

/// What both ends of an intent agree on.
template <class Qos>
Qos qos_of(Intent intent) {
  const bool latched = intent == Intent::kLatched || intent == Intent::kStop;
  Qos qos;
  qos.data_sharing().off();
  qos.reliability().kind =
      latched || intent == Intent::kEvent ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.endpoint().history_memory_policy =
      intent == Intent::kStream ? rtps::PREALLOCATED_MEMORY_MODE : rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  return qos;
}

}  // namespace

std::size_t kept_samples(Intent intent) {
  return intent == Intent::kEvent ? kEvents : intent == Intent::kStop ? kStops : 1;
}

dds::DataWriterQos writer_qos(Intent intent) {
  auto qos = qos_of<dds::DataWriterQos>(intent);
  qos.history().depth = static_cast<std::int32_t>(kept_samples(intent));
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  switch (intent) {
    case Intent::kStream:  // allocates nothing
      qos.resource_limits().max_samples = 1;
      qos.resource_limits().max_instances = 1;
      qos.resource_limits().max_samples_per_instance = 1;
      qos.resource_limits().allocated_samples = 1;
      break;
    case Intent::kLatched:  // large: repairs are asked for calmly, so that a long round trip does not
                            // multiply them
      qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
      middleware::set_times(qos, {milliseconds(5), milliseconds(200), milliseconds(5)});
      break;
    case Intent::kEvent:  // small and rare: repaired at once
      middleware::set_times(qos, {milliseconds(0), milliseconds(5), milliseconds(0)});
      break;
    case Intent::kStop:
      middleware::set_times(qos, {milliseconds(0), milliseconds(20), milliseconds(0)});
      break;
    case Intent::kSlow:
      break;
  }
  return qos;
}

dds::DataReaderQos reader_qos(Intent intent) {
  auto qos = qos_of<dds::DataReaderQos>(intent);
  qos.history().depth = 32;  // the listener takes each one at once; this is for bursts
  if (intent == Intent::kLatched) qos.history().depth = 4;
  if (intent == Intent::kEvent || intent == Intent::kStop) {
    qos.history().depth = kEvents;
    middleware::set_answer_time(qos, milliseconds(0));
  }
  return qos;
}

}  // namespace telekerf::bus
