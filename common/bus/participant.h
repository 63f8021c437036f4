// SPDX-License-Identifier: Apache-2.0
// The DDS participant behind a Bus, and what it knows about its neighbours. Inside the bus only.
#pragma once

#include <atomic>
#include <condition_variable>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "common/bus/bus.h"
#include "common/bus/departures.h"
#include "common/bus/middleware.h"
#include "common/bus/network_watch.h"
#include "common/bus/participant_qos.h"
#include "common/bus/presence.h"
#include "common/bus/protection.h"
#include "common/bus/reunion.h"

namespace telekerf {

class Bus::Participant : private middleware::Discovery {
 public:
  explicit Participant(BusSettings settings);
  ~Participant() override;

  /// Looks for others and joins; see Bus::Bus.
  void join();

  const BusSettings& settings() const { return settings_; }
  const std::vector<std::string>& notes() const { return notes_; }
  std::vector<PresenceMessage> others() const;
  std::vector<Bus::Seen> seen() const;
  bool wait_for_role(const std::string& role, std::chrono::nanoseconds timeout) const;
  BusCounters counters() const;
  std::vector<std::string> strangers() const;
  std::vector<PresenceMessage> elsewhere() const;
  std::string unheard() const;
  std::optional<Rival> rival() const;
  bus::Protection& protection() { return protection_; }

  /// In a thread of the middleware, no allocation if it may. Whether this writer's process has announced
  /// itself in this cell, in this role (null: any) and as the start `epoch`. Whoever has not is remembered.
  bool may_say(const middleware::rtps::GUID_t& writer, const char* topic, const char* role,
               std::optional<std::uint32_t> epoch);

  /// The topic of this name, created at first use; `type` is registered then.
  eprosima::fastdds::dds::Topic* topic(const char* name, const eprosima::fastdds::dds::TypeSupport& type);
  eprosima::fastdds::dds::Publisher* publisher() { return publisher_; }
  eprosima::fastdds::dds::Subscriber* subscriber() { return subscriber_; }
  /// A reader or writer. All are made anew, with the participant, where this computer's addresses have
  /// changed.
  class Endpoint {
   public:
    /// Throws StartupError.
    virtual void open() = 0;
    virtual void close() = 0;

   protected:
    ~Endpoint() = default;
  };
  /// Opens it. Throws StartupError.
  void add(Endpoint* endpoint);
  /// Closes it.
  void remove(Endpoint* endpoint);
  bool is_own(const middleware::rtps::GUID_t& writer) const {
    return writer.guidPrefix == participant_->guid().guidPrefix;
  }

 private:
  using Key = std::array<std::uint8_t, 12>;

  void discovered(const Discovered& participant) override;
  void discovered(const DiscoveredWriter& writer) override;
  void authenticated(const middleware::rtps::GUID_t& guid, bool proven) override;
  void create();
  void announce_protected();
  void announce(const Key& key, const PresenceMessage& presence);
  void destroy();
  void wait_for_objections();
  void addresses_changed(bool lost);
  bool is_of_this_cell(const Key& key) const;  ///< by the name that it gives, not yet proved
  void meet_again(const std::vector<bus::Unproven::Waiting>& strange);
  /// Both sites are seen.
  bool whole() const;
  std::string stranger(const Key& key, const char* topic, const char* role) const;
  /// Of one who has not proved who it is, for people.
  std::string unproven(const Key& key) const;
  /// Where it is, for people.
  std::string place(const Key& key) const;

  BusSettings settings_;
  bus::Protection protection_;
  std::vector<std::string> notes_;
  std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp_;
  std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport_;
  std::vector<std::unique_ptr<bus::ParticipantNumber>> numbers_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  eprosima::fastdds::dds::DataWriter* announcer_ =
      nullptr;  // with security: who we are, told to those who are authenticated
  std::mutex topics_mutex_;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  Neighbour self_;
  std::map<Key, Neighbour> others_;
  bus::Departures departures_;
  std::set<Key> incompatible_;  // seen since we joined
  std::mutex endpoints_mutex_;
  std::set<Endpoint*> endpoints_;
  std::set<Key> authenticated_;  // with security
  std::set<Key> with_keys_;      // without security: those that have some
  std::map<Key, PresenceMessage> elsewhere_;
  std::map<Key, std::string> addresses_;   // of everyone seen in the domain, for people
  std::map<Key, std::string> strangers_;   // a sentence each
  std::unique_ptr<bus::Reunion> reunion_;  // with security
  std::unique_ptr<NetworkWatch> network_;  // last: ends first
};

}  // namespace telekerf
