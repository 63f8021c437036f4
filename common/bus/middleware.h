// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2.9 (Debian 12) and 3.1 (Debian 13) under one set of names: what the two call differently, and
// nothing else. Inside the bus and its receive filters only.
#pragma once

#if __has_include(<fastdds/LibrarySettings.hpp>)
#define TELEKERF_FASTDDS_3 1
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/rtps/builtin/data/ParticipantBuiltinTopicData.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/TransportDescriptorInterface.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#if __has_include(<fastdds/rtps/network/SenderResource.h>)
#include <fastdds/rtps/network/SenderResource.h>
#else
#include <fastdds/rtps/transport/SenderResource.h>
#endif
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace telekerf::middleware {

namespace dds = eprosima::fastdds::dds;

#ifdef TELEKERF_FASTDDS_3

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastdds::dds::Duration_t;
using Payload = rtps::SerializedPayload_t&;                ///< as a type's deserializer gets it
using Datagram = const std::vector<rtps::NetworkBuffer>&;  ///< as a transport gets it

/// The datagram's bytes; where it comes in parts, they are put together in `room`. Empty: it does not fit.
inline std::span<const std::byte> in_one_piece(Datagram parts, std::uint32_t size,
                                               std::span<std::byte> room) {
  if (parts.size() == 1) return {static_cast<const std::byte*>(parts.front().buffer), parts.front().size};
  if (size > room.size()) return {};
  std::size_t at = 0;
  for (const rtps::NetworkBuffer& part : parts) {
    if (part.size > room.size() - at) return {};
    std::memcpy(room.data() + at, part.buffer, part.size);
    at += part.size;
  }
  return room.first(at);
}
inline constexpr std::size_t kDatagramRoom = 65536;  ///< for in_one_piece(): the longest of UDP fits

/// What an operation of the middleware came to. Never compare it by hand: 0 is good here, and true in 2.9.
inline bool succeeded(dds::ReturnCode_t code) { return code == dds::RETCODE_OK; }
bool succeeded(bool) = delete;

/// Whether what a process says to itself goes without datagrams.
inline void deliver_within_a_process(bool shortly) {
  eprosima::fastdds::LibrarySettings library;
  library.intraprocess_delivery =
      shortly ? eprosima::fastdds::INTRAPROCESS_FULL : eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(library);
}

#else

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::Duration_t;
using Payload = rtps::SerializedPayload_t*;
using Datagram = const rtps::octet*;

inline std::span<const std::byte> in_one_piece(Datagram bytes, std::uint32_t size, std::span<std::byte>) {
  return std::as_bytes(std::span(bytes, size));
}
inline constexpr std::size_t kDatagramRoom = 0;

inline bool succeeded(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
inline bool succeeded(bool done) { return done; }

inline void deliver_within_a_process(bool shortly) {
  eprosima::fastrtps::LibrarySettingsAttributes library;
  library.intraprocess_delivery =
      shortly ? eprosima::fastrtps::INTRAPROCESS_FULL : eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
}

#endif

/// How long a reliable writer waits.
struct WriterTimes {
  Duration_t first_heartbeat, heartbeats, answer_to_a_loss;
};
inline void set_times(dds::DataWriterQos& qos, const WriterTimes& wanted) {
  auto& times = qos.reliable_writer_qos().times;
#ifdef TELEKERF_FASTDDS_3
  times.initial_heartbeat_delay = wanted.first_heartbeat;
  times.heartbeat_period = wanted.heartbeats;
  times.nack_response_delay = wanted.answer_to_a_loss;
#else
  times.initialHeartbeatDelay = wanted.first_heartbeat;
  times.heartbeatPeriod = wanted.heartbeats;
  times.nackResponseDelay = wanted.answer_to_a_loss;
#endif
}
/// How long a reliable reader waits before it asks for what it misses.
template <class ReaderQos>
void set_answer_time(ReaderQos& qos, const Duration_t& wanted) {
#ifdef TELEKERF_FASTDDS_3
  qos.reliable_reader_qos().times.heartbeat_response_delay = wanted;
#else
  qos.reliable_reader_qos().times.heartbeatResponseDelay = wanted;
#endif
}

/// Fast DDS 3 reads this computer's addresses once for all participants, and anew when one is given a QoS.
inline void look_at_networks(dds::DomainParticipant& participant) {
#ifdef TELEKERF_FASTDDS_3
  (void)participant.set_qos(participant.get_qos());
#else
  (void)participant;
#endif
}

/// Another participant was seen, has changed, or is gone.
class Discovery : public dds::DomainParticipantListener {
 public:
  struct Discovered {
    const rtps::GUID_t& guid;
    bool gone;
    bool lapsed;  ///< gone without a farewell: it was not heard for as long as it had said
    const std::vector<rtps::octet>& user_data;
    const rtps::RemoteLocatorList& data_locators;
    const rtps::RemoteLocatorList& discovery_locators;
  };
  struct DiscoveredWriter {
    const rtps::GUID_t& guid;
    bool gone;
    std::string_view topic;
    std::span<const rtps::octet> user_data;
  };
  /// All in threads of the middleware.
  virtual void discovered(const Discovered& participant) = 0;
  virtual void discovered(const DiscoveredWriter& writer) = 0;
  /// With security: a participant has proved who it is, or has failed to.
  virtual void authenticated(const rtps::GUID_t& guid, bool proven) = 0;

 private:
  void onParticipantAuthentication(dds::DomainParticipant*,
                                   rtps::ParticipantAuthenticationInfo&& info) final {
    authenticated(info.guid, info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT);
  }
#ifdef TELEKERF_FASTDDS_3
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus status,
                                const dds::ParticipantBuiltinTopicData& data, bool&) final {
    using Status = rtps::ParticipantDiscoveryStatus;
    discovered(Discovered{data.guid,
                          status == Status::REMOVED_PARTICIPANT || status == Status::DROPPED_PARTICIPANT,
                          status == Status::DROPPED_PARTICIPANT, data.user_data, data.default_locators, data.metatraffic_locators});
  }
  void on_data_writer_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryStatus status,
                                const dds::PublicationBuiltinTopicData& data, bool&) final {
    discovered(DiscoveredWriter{data.guid,
                                status == rtps::WriterDiscoveryStatus::REMOVED_WRITER,
                                data.topic_name.c_str(),
                                { data.user_data.data(),
                                  data.user_data.size() }});
  }
#else
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) final {
    using Status = rtps::ParticipantDiscoveryInfo;
    discovered(
        Discovered{info.info.m_guid,
                   info.status == Status::REMOVED_PARTICIPANT || info.status == Status::DROPPED_PARTICIPANT,
                   info.status == Status::DROPPED_PARTICIPANT, info.info.m_userData, info.info.default_locators, info.info.metatraffic_locators});
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) final {
    const auto& user_data = info.info.m_qos.m_userData;
    discovered(DiscoveredWriter{info.info.guid(),
                                info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER,
                                info.info.topicName().c_str(),
                                {user_data.data(), user_data.size()}});
  }
#endif
};

}  // namespace telekerf::middleware
