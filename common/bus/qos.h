// SPDX-License-Identifier: Apache-2.0
// Fast DDS settings: of the participant, and of readers and writers by intent. Inside the bus only.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/topics.h"

namespace telekerf::bus {

inline constexpr std::uint32_t kSocketBufferBytes = 4u << 20;

/// Library-wide, before the first participant: no profile files from the working directory, no discovery
/// server from the environment, no intraprocess short cut (the emulated link would not see its datagrams).
void settle_library();

/// UDPv4 transport as all participants use it.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp_transport();

/// `transport` is the only one; `user_data` is announced. Throws StartupError for a peer that does not
/// resolve.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(
    const BusSettings& settings,
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
    const std::vector<std::uint8_t>& user_data);

eprosima::fastdds::dds::DataWriterQos writer_qos(Intent intent);
eprosima::fastdds::dds::DataReaderQos reader_qos(Intent intent);

/// A sentence if this kernel clips our socket buffers; empty otherwise.
std::string socket_buffer_note();

}  // namespace telekerf::bus
