// SPDX-License-Identifier: Apache-2.0
// What may stand between the network and a participant, e.g. the emulation of another network
// (netem/drivers).
#pragma once

#include <memory>

#include "common/protocol/site.h"

namespace eprosima::fastdds::rtps {
struct TransportDescriptorInterface;
}

namespace telekerf {

/// A filter in the receive path of one participant, which shares its ownership. `Transport` is the
/// middleware's word for sockets and what is chained before them.
class ReceiveFilter {
 public:
  using Transport = eprosima::fastdds::rtps::TransportDescriptorInterface;

  ReceiveFilter() = default;
  virtual ~ReceiveFilter() = default;
  ReceiveFilter(const ReceiveFilter&) = delete;
  ReceiveFilter& operator=(const ReceiveFilter&) = delete;

  /// `below` (UDPv4) with this filter on its receiving side; called once, before the participant is made.
  /// `sites`: how participants' prefixes tell where they are.
  virtual std::shared_ptr<Transport> over(std::shared_ptr<Transport> below, const SiteTable& sites) = 0;
};

}  // namespace telekerf
