// SPDX-License-Identifier: Apache-2.0
// Announcements, handshakes and exchanges of keys reach the middleware one after the other. Inside the bus
// only.
//
// Fast DDS 2.9 takes a participant in with two threads, that of discovery's multicast port and that of its
// unicast port, and both write who it is into the same members of SecurityManager (match_builtin_endpoints(),
// match_builtin_key_exchange_endpoints()), without a lock. Where two participants were found at the same
// moment, one of them was then listened to under the other's prefix: its handshake never ended, and it was
// never seen. It happened where three processes of a secured cell start together on a busy machine.
#pragma once

#include <memory>

#include "common/bus/middleware.h"

namespace telekerf::bus {

/// `below`, from which what is not protected (DDS Security 1.1, 7.3.6) arrives one datagram at a time,
/// whichever port it came to. Protected datagrams, the streams' among them, wait for nobody.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> one_by_one_over(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below);

}  // namespace telekerf::bus
