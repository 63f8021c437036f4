// SPDX-License-Identifier: Apache-2.0
// What the middleware adds to a datagram and nobody needs is left out before it is sent. Inside the bus only.
//
// Debian's build of Fast DDS appends 60 bytes of statistics to every datagram, without a switch at run time;
// its UDP transport writes into them, so they can be left out only by sending without it. A stream's datagram
// also names the one who is meant (INFO_DST, 16 bytes) and the time of writing (INFO_TS, 12): it is sent to
// one socket of one participant, and blocks carry a stamp of their own. RTPS 2.x, 8.3.4 and 8.3.7: both
// submessages are optional.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "common/bus/gate.h"
#include "common/bus/middleware.h"

namespace telekerf::bus {

/// The parts of a datagram that are worth sending, in this order: `head` and `rest`.
struct TrimmedDatagram {
  std::span<const std::byte> head;
  std::span<const std::byte> rest;
};

/// Whatever is not known for certain stays whole: everything is in `head`. Of a protected message the
/// statistics alone are left out, which stand behind what is signed.
TrimmedDatagram trimmed(std::span<const std::byte> datagram) noexcept;

/// `below` (UDPv4): what is meant for one host is trimmed and sent by a socket of our own, multicast goes on
/// to it. What arrives goes on if the gate admits it; null: all of it.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> trimming_over(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below,
    std::shared_ptr<Gate> gate = nullptr);

}  // namespace telekerf::bus
