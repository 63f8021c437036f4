// SPDX-License-Identifier: Apache-2.0
#include "common/bus/participant.h"

#include <fmt/format.h>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <algorithm>

#include "common/bus/interfaces.h"
#include "common/bus/participant_qos.h"
#include "common/bus/qos.h"
#include "common/bus/serial_discovery.h"
#include "common/bus/trimming_transport.h"
#include "common/bus/wire_messages.h"
#include "common/runtime/clock.h"
#include "common/runtime/real_time.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"

namespace telekerf {
namespace {

namespace dds = middleware::dds;
namespace rtps = middleware::rtps;

constexpr std::chrono::milliseconds kHandshake{1500};  ///< that a handshake with a lost key takes longer

/// What is kept for people of participants that are none of ours.
constexpr std::size_t kMostStrangers = 64;
constexpr std::size_t kMostAddresses = 1024;

std::array<std::uint8_t, 12> key_of(const rtps::GUID_t& guid) {
  std::array<std::uint8_t, 12> key{};
  std::copy(std::begin(guid.guidPrefix.value), std::end(guid.guidPrefix.value), key.begin());
  return key;
}

/// A prefix that follows from a certificate begins with a bit that no other has (DDS Security 1.1, 9.3.3); a
/// vendor's own begins with its number.
bool is_of_keys(const std::array<std::uint8_t, 12>& key) { return (key[0] & 0x80) != 0; }

}  // namespace

Bus::Participant::Participant(BusSettings settings)
    : settings_(bus::validated(std::move(settings))), protection_(settings_), udp_(bus::udp_transport()) {
  bus::settle_library(protection_.on());
  self_.presence = {.contract = settings_.contract,
                    .cell = settings_.cell,
                    .role = settings_.role,
                    .name = settings_.name,
                    .epoch = settings_.epoch,
                    .joined = false,
                    .version = kVersion};
  if (std::string note = bus::socket_buffer_note(); !note.empty()) notes_.push_back(std::move(note));
  transport_ = bus::trimming_over(udp_, protection_.gate());
  if (settings_.receive_filter)
    transport_ = settings_.receive_filter->over(std::move(transport_), protection_.sites());
  if (protection_.on()) transport_ = bus::one_by_one_over(std::move(transport_));
  const std::lock_guard lock(endpoints_mutex_);
  if (protection_.on())
    reunion_ = std::make_unique<bus::Reunion>([this](const auto& strange) { meet_again(strange); });
  create();
}

void Bus::Participant::create() {
  const auto announced = bus::presence_bytes(self_.presence);
  if (announced.empty())
    throw usage_error("the names of cell, role and process may have 64, 32 and 64 letters");
  const bool inside = !settings_.outside && !protection_.on();
  udp_->interfaceWhiteList = inside ? bus::inner_addresses() : std::vector<std::string>{};
  if (!udp_->interfaceWhiteList.empty()) bus::refuse_peers_outside(settings_, udp_->interfaceWhiteList);
  auto qos = bus::participant_qos(settings_, transport_, announced);
  if (protection_.on()) protection_.apply(qos);
  // The threads that receive are started here. A busy machine would let them wait, and that looks like a bad
  // link.
  const RealTimePriority inherited(kNetworkPriority);
  bus::require_discovery_port(settings_.domain);
  // Another number each time: whoever has not forgotten the one before would take the ports for its own.
  numbers_.push_back(std::make_unique<bus::ParticipantNumber>(settings_.domain));
  if (numbers_.back()->value() < 0) {
    numbers_.clear();
    numbers_.push_back(std::make_unique<bus::ParticipantNumber>(settings_.domain));
  }
  qos.wire_protocol().participant_id = numbers_.back()->value();
  participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(settings_.domain), qos, this, dds::StatusMask::none());
  if (participant_ == nullptr) {
    throw environment_error(
        fmt::format("no DDS participant in domain {}: is the network up, and are UDP ports from {} free?",
                    settings_.domain, 7400 + 250 * settings_.domain));
  }
  {
    const std::lock_guard lock(mutex_);
    self_.key = key_of(participant_->guid());  // another one than asked for, with security
  }
  dds::PublisherQos publisher_qos;
  publisher_qos.partition().push_back(settings_.cell.c_str());
  publisher_ = participant_->create_publisher(publisher_qos);
  dds::SubscriberQos subscriber_qos;
  subscriber_qos.partition().push_back(settings_.cell.c_str());
  subscriber_ = participant_->create_subscriber(subscriber_qos);
  if (protection_.on()) announce_protected();
}

void Bus::Participant::destroy() {
  if (participant_ == nullptr) return;
  participant_->set_listener(nullptr);
  participant_->delete_contained_entities();
  announcer_ = nullptr;
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  participant_ = nullptr;
}

Bus::Participant::~Participant() {
  network_.reset();
  reunion_.reset();
  destroy();
}

void Bus::Participant::wait_for_objections() {
  const auto end = std::chrono::steady_clock::now() + settings_.discovery_wait;
  std::unique_lock lock(mutex_);
  const auto objection = [&](bool by_the_joined) -> std::optional<std::string> {
    for (const auto& [key, other] : others_) {
      if (by_the_joined != other.presence.joined || !must_give_way(self_, other)) continue;
      if (auto reason = incompatibility(self_.presence, other.presence)) return reason;
    }
    return std::nullopt;
  };
  std::optional<std::string> reason;
  // Who has joined is final; who still looks around may yet give way to a third, so those are judged at the
  // end.
  changed_.wait_until(lock, end, [&] { return (reason = objection(true)).has_value(); });
  // Who has this role's keys is about to say who it is: a handshake may take a second longer.
  const auto unheard = [&] {
    return std::any_of(addresses_.begin(), addresses_.end(), [&](const auto& seen) {
      const auto* const identity = protection_.identity(seen.first);
      return identity != nullptr && identity->role == settings_.role && identity->cell == settings_.cell &&
             seen.first != self_.key && !others_.contains(seen.first);
    });
  };
  if (!reason && settings_.discovery_wait.count() > 0 && unheard())
    changed_.wait_until(lock, end + kHandshake,
                        [&] { return (reason = objection(true)).has_value() || !unheard(); });
  if (!reason) reason = objection(false);
  if (reason) throw environment_error(*reason);
  self_.presence.joined = true;
}

void Bus::Participant::join() {
  wait_for_objections();
  if (protection_.on()) {
    announce_protected();
  } else {
    dds::DomainParticipantQos qos = participant_->get_qos();
    qos.user_data().data_vec(bus::presence_bytes(self_.presence));
    if (!middleware::succeeded(participant_->set_qos(qos)))
      throw environment_error("the middleware did not take the announcement");
  }
  network_ = std::make_unique<NetworkWatch>([this](bool lost) { addresses_changed(lost); });
}

void Bus::Participant::addresses_changed(bool lost) {
  // The middleware notices new interfaces when it is told to look, but whoever has found this participant
  // before goes on with the addresses of then (Fast DDS 2.9). So it is made anew, unless that would interrupt
  // what still works.
  const bool leads_out = !settings_.outside && !protection_.on() && udp_->interfaceWhiteList.empty() &&
                         !bus::inner_addresses().empty();
  if (!lost && whole() && !leads_out) return;
  const std::lock_guard lock(endpoints_mutex_);
  for (Endpoint* const endpoint : endpoints_) endpoint->close();
  if (participant_ != nullptr) middleware::look_at_networks(*participant_);
  destroy();
  {
    const std::lock_guard neighbours(mutex_);
    others_.clear();
    authenticated_.clear();
    with_keys_.clear();
    elsewhere_.clear();
    addresses_.clear();
  }
  if (reunion_) reunion_->clear();
  try {
    create();
    for (Endpoint* const endpoint : endpoints_) endpoint->open();
  } catch (const StartupError& refusal) {
    write_line(stderr, fmt::format("{}: after a change of the network: {}", settings_.role, refusal.what()));
  }
}

bool Bus::Participant::whole() const {
  const auto role = [this](const char* name) {
    return settings_.role == name || std::any_of(others_.begin(), others_.end(), [&](const auto& other) {
             return other.second.presence.role == name;
           });
  };
  const std::lock_guard lock(mutex_);
  return role("master") && role("slave");
}

void Bus::Participant::add(Endpoint* endpoint) {
  const std::lock_guard lock(endpoints_mutex_);
  endpoint->open();
  endpoints_.insert(endpoint);
}

void Bus::Participant::remove(Endpoint* endpoint) {
  const std::lock_guard lock(endpoints_mutex_);
  endpoints_.erase(endpoint);
  endpoint->close();
}

void Bus::Participant::discovered(const Discovered& participant) {
  const Key key = key_of(participant.guid);
  const bool gone = participant.gone;
  PresenceMessage presence;
  // Announcements are clear, and anybody can write them: with security who they are is heard elsewhere.
  const bool told = !gone && !protection_.on() && bus::read_presence(participant.user_data, presence);
  {
    const std::lock_guard lock(mutex_);
    if (gone) {
      if (const auto other = others_.find(key); other != others_.end()) departures_.note(key, other->second);
      others_.erase(key);
      authenticated_.erase(key);
      elsewhere_.erase(key);
      addresses_.erase(key);
      with_keys_.erase(key);
    } else if (addresses_.size() < kMostAddresses) {
      addresses_[key] = bus::address_of(participant);
      if (!protection_.on() && is_of_keys(key)) with_keys_.insert(key);
    }
    if (told) announce(key, presence);
  }
  if (reunion_ && gone) {
    reunion_->gone(key, participant.lapsed);
  } else if (reunion_) {
    if (is_of_this_cell(key))
      reunion_->found(key, {participant.discovery_locators.unicast.begin(),
                            participant.discovery_locators.unicast.end()});
  }
  changed_.notify_all();
}

bool Bus::Participant::is_of_this_cell(const Key& key) const {
  const auto* const identity = protection_.identity(key);
  return identity != nullptr && identity->cell == settings_.cell;
}

/// In the reunion's thread.
void Bus::Participant::meet_again(const std::vector<bus::Unproven::Waiting>& strange) {
  const std::lock_guard lock(endpoints_mutex_);
  if (participant_ == nullptr) return;
  {
    const std::lock_guard neighbours(mutex_);
    for (const auto& other : strange) strangers_[other.key] = unproven(other.key);
  }
  for (const auto& other : strange)
    bus::send_datagram(bus::farewell(key_of(participant_->guid()), other.key), other.places);
}

void Bus::Participant::announce(const Key& key, const PresenceMessage& presence) {
  if (presence.cell != settings_.cell) {
    elsewhere_[key] = presence;
    return;
  }
  others_[key] = {.presence = presence, .key = key};
  if (self_.presence.joined && incompatibility(self_.presence, presence)) incompatible_.insert(key);
}

void Bus::Participant::authenticated(const rtps::GUID_t& guid, bool proven) {
  const Key key = key_of(guid);
  if (proven && protection_.on()) protection_.gate()->proven(key, monotonic_ns());
  if (proven && reunion_) reunion_->proved(key);
  if (!proven && reunion_ && is_of_this_cell(key)) reunion_->refused(key);
  const std::lock_guard lock(mutex_);
  if (proven) {
    authenticated_.insert(key);
    strangers_.erase(key);  // it may have been slow
  } else {
    authenticated_.erase(key);
    const std::uint32_t from = protection_.on() ? protection_.gate()->unproven_from(key) : 0;
    if (from != 0 && addresses_.size() < kMostAddresses) addresses_.try_emplace(key, bus::dotted(from));
  }
}

void Bus::Participant::discovered(const DiscoveredWriter& writer) {
  if (!protection_.on() || writer.gone || writer.topic != security::kPresenceTopic) return;
  const Key key = key_of(writer.guid);
  PresenceMessage presence;
  if (!bus::read_presence(writer.user_data, presence) || !protection_.fits(key, presence)) return;
  {
    const std::lock_guard lock(mutex_);
    if (!authenticated_.contains(key)) return;
    announce(key, presence);
  }
  changed_.notify_all();
}

/// Who we are, in the user data of a writer: unlike the participant's own these are encrypted, for those who
/// are authenticated.
void Bus::Participant::announce_protected() {
  dds::DataWriterQos qos = bus::writer_qos(bus::Intent::kSlow);
  qos.user_data().data_vec(bus::presence_bytes(self_.presence));
  if (announcer_ != nullptr) {
    (void)announcer_->set_qos(qos);
    return;
  }
  const dds::TypeSupport type(new wire::PresencePubSubType);
  dds::Topic* const told = topic(security::kPresenceTopic, type);
  announcer_ = told == nullptr ? nullptr : publisher_->create_datawriter(told, qos);
  if (announcer_ == nullptr)
    throw environment_error("the middleware refused a writer of " + std::string(security::kPresenceTopic));
}

bool Bus::Participant::wait_for_role(const std::string& role, std::chrono::nanoseconds timeout) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] {
    return std::any_of(others_.begin(), others_.end(), [&](const auto& entry) {
      return entry.second.presence.role == role && entry.second.presence.joined;
    });
  });
}

bool Bus::Participant::may_say(const rtps::GUID_t& writer, const char* topic, const char* role,
                               std::optional<std::uint32_t> epoch) {
  const Key key = key_of(writer);
  const std::lock_guard lock(mutex_);
  if (!protection_.on() && !others_.contains(key)) {
    if (const auto who = departures_.heard(key)) others_[key] = *who;
  }
  const auto other = others_.find(key);
  if (other != others_.end()) {
    const PresenceMessage& presence = other->second.presence;
    if ((role == nullptr || presence.role == role) && presence.epoch == epoch.value_or(presence.epoch))
      return true;
  }
  if (strangers_.size() < kMostStrangers && !strangers_.contains(key))
    strangers_[key] = stranger(key, topic, role);
  return false;
}

dds::Topic* Bus::Participant::topic(const char* name, const dds::TypeSupport& type) {
  const std::lock_guard lock(topics_mutex_);
  if (auto* existing = participant_->lookup_topicdescription(name))
    return dynamic_cast<dds::Topic*>(existing);
  type.register_type(participant_);
  return participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
}

}  // namespace telekerf
