// SPDX-License-Identifier: Apache-2.0
// Fast DDS settings of the library, of the transport and of the participant. Inside the bus only.
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/middleware.h"

namespace telekerf::bus {

inline constexpr std::uint32_t kSocketBufferBytes = 4u << 20;

/// With the name that is meant. Throws StartupError: a domain out of range, a cell's name that is none.
BusSettings validated(BusSettings settings);

/// Library-wide, before a participant: no profile files from the working directory, no discovery server from
/// the environment, no intraprocess short cut (the emulated link would not see its datagrams). `secured`:
/// with it, for a participant does not understand what it has signed itself, and its readers would ask its
/// own writers for ever; no two participants' prefixes look like those of one process, so that it goes no
/// further.
void settle_library(bool secured);

/// UDPv4 transport as all participants use it.
std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp_transport();

/// Throws StartupError where another program has the domain's multicast port for itself: the middleware would
/// go on without a word, and nobody would ever be found. Ports of domains from 102 on (32,900 and above) are
/// among those that the kernel gives to any program that sends.
void require_discovery_port(int domain);

/// A number for a participant of this host whose two ports are free, and which no other process of ours takes
/// as long as this lives. The middleware must be told one: left to itself it takes other ports when these are
/// in use, but from set_qos() on announces those of number 0 as well, and every sample crosses the network
/// twice (Fast DDS 2.9, eProsima/Fast-DDS#2676).
class ParticipantNumber {
 public:
  explicit ParticipantNumber(int domain);
  ~ParticipantNumber();
  ParticipantNumber(const ParticipantNumber&) = delete;
  ParticipantNumber& operator=(const ParticipantNumber&) = delete;
  /// Negative: there is none.
  int value() const noexcept { return value_; }

 private:
  int value_ = -1;
  int claim_ = -1;
};

/// `transport` is the only one; `user_data` is announced. Throws StartupError for a peer that does not
/// resolve.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(
    const BusSettings& settings,
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
    const std::vector<std::uint8_t>& user_data);

/// Where it is, for people.
std::string address_of(const middleware::Discovery::Discovered& participant);

/// Throws StartupError for a peer that is reached through none of these addresses of this computer.
void refuse_peers_outside(const BusSettings& settings, const std::vector<std::string>& inner);

/// A sentence if this kernel clips our socket buffers; empty otherwise.
std::string socket_buffer_note();

}  // namespace telekerf::bus
