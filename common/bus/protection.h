// SPDX-License-Identifier: Apache-2.0
// Who a participant lets in: with DDS Security whoever proves to have keys of its cell, without it whoever
// its networks reach. Inside the bus only.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/expiry.h"
#include "common/bus/gate.h"
#include "common/bus/security/keystore_check.h"
#include "common/protocol/site.h"

namespace telekerf::bus {

class Protection {
 public:
  using Key = std::array<std::uint8_t, 12>;
  struct Identity {
    std::string cell;
    std::string role;
    Site site = Site::kOperator;
    std::optional<security::Time> end;  ///< of its certificate, where this computer has it
  };

  /// Throws StartupError for whatever the middleware would fail on without saying why, and for keys that end
  /// so soon that a work begun now would.
  explicit Protection(const BusSettings& settings);

  bool on() const noexcept { return gate_ != nullptr; }
  /// The keys, for the middleware. Only if on().
  void apply(eprosima::fastdds::dds::DomainParticipantQos& qos) const;
  /// Null: everything is let in.
  const std::shared_ptr<Gate>& gate() const { return gate_; }
  /// How prefixes tell sites.
  SiteTable sites() const;
  /// Whose prefix this is, if a participant has proved that it is its own; null: nobody's of ours.
  const Identity* identity(const Key& prefix) const;
  /// Whether this presence may be told under this prefix.
  bool fits(const Key& prefix, const PresenceMessage& presence) const;

  /// Who of the cell is not heard because its messages are protected otherwise, in a sentence with the
  /// remedy; empty: nobody. Only if on().
  std::string otherwise() const;

  std::string sentence() const;
  std::vector<std::string> dates();
  bool lets_go() const noexcept { return lets_go_.load(std::memory_order_relaxed); }
  std::string ended() const;

 private:
  void read_keys();
  void read_dates(const security::Validity& own);

  BusSettings settings_;
  std::map<security::SubjectPrefix, Identity> identities_;
  std::shared_ptr<Gate> gate_;
  Expiry expiry_;
  std::string until_;
  std::atomic<bool> lets_go_{false};
};

}  // namespace telekerf::bus
