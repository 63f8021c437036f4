// SPDX-License-Identifier: Apache-2.0
// Fast DDS settings of the library, of the transport and of the participant. Inside the bus only.
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"

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

/// A sentence if this kernel clips our socket buffers; empty otherwise.
std::string socket_buffer_note();

}  // namespace telekerf::bus
