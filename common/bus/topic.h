// SPDX-License-Identifier: Apache-2.0
// A topic as the middleware has it, created at first use. Inside the bus only.
#pragma once

#include <exception>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <string>

#include "common/bus/middleware.h"
#include "common/bus/participant.h"
#include "common/bus/topics.h"
#include "common/runtime/startup_error.h"

namespace telekerf::bus {

/// Set by a type's deserializer, read by the listener that called it, in one thread: bytes that are not even
/// CDR.
inline thread_local bool undecodable = false;  // NOLINT

/// Generated serializers throw through the middleware when bytes are broken in some places and return false
/// in others.
template <class Type>
class Guarded : public Type {
 public:
  bool deserialize(middleware::Payload payload, void* data) override {
    bool good = false;
    try {
      good = Type::deserialize(payload, data);
    } catch (const std::exception&) {
    }
    undecodable = undecodable || !good;
    return good;
  }
};

/// Throws StartupError when the middleware refuses it.
template <class T>
eprosima::fastdds::dds::Topic* topic_of(Bus::Participant& participant) {
  const eprosima::fastdds::dds::TypeSupport type(new Guarded<typename Topic<T>::Type>);
  auto* const topic = participant.topic(Topic<T>::kName, type);
  if (topic == nullptr)
    throw environment_error(std::string("the middleware refused topic ") + Topic<T>::kName);
  return topic;
}

}  // namespace telekerf::bus
