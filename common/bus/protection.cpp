// SPDX-License-Identifier: Apache-2.0
#include "common/bus/protection.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "common/bus/interfaces.h"
#include "common/bus/security/keystore.h"
#include "common/bus/security/roles.h"
#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"

namespace telekerf::bus {
namespace {

namespace fs = std::filesystem;

// What the middleware keeps of a participant that announces itself, it keeps for as long as that says.
constexpr std::size_t kMostParticipants = 256;

bool leads(const std::string& role) { return role == "master" || role == "slave"; }

}  // namespace

Protection::Protection(const BusSettings& settings) : settings_(settings), expiry_({}) {
  if (!settings.security.empty()) read_keys();
}

void Protection::read_keys() {
  settings_.security = fs::absolute(settings_.security).lexically_normal().string();
  if (settings_.domain > security::kHighestSecuredDomain)
    throw usage_error(fmt::format("domain {}: with security it must be within [0, {}]", settings_.domain,
                                  security::kHighestSecuredDomain));
  const security::Time now = std::chrono::system_clock::now();
  const security::KeystoreReport report =
      security::check_role(settings_.security, settings_.cell, settings_.role, settings_.wan, now);
  if (!report.faults.empty()) throw configuration_error("security: " + report.faults.front());
  if (ends_too_soon(*report.first_to_end, now))
    throw configuration_error(fmt::format(
        "security: {} ends on {}, too soon to begin anything; ./telekerf keys DIR --renew makes it anew",
        report.first_to_end->file, security::text_of(report.first_to_end->end)));

  std::vector<security::SubjectPrefix> known;
  for (const std::string& cell : security::cells_of(settings_.security)) {
    for (const security::Role& role : security::roles()) {
      const auto prefix = security::prefix_of(cell, security::common_name(cell, role.name));
      const auto file = security::role_files(settings_.security, cell, role.name).certificate;
      known.push_back(prefix);
      identities_[prefix] = {cell, role.name, role.site, security::certificate_end(file)};
    }
  }
  gate_ = std::make_shared<Gate>(std::move(known),
                                 settings_.wan ? MessageProtection::kEncrypted : MessageProtection::kSigned);
  read_dates(*report.first_to_end);
}

void Protection::read_dates(const security::Validity& own) {
  until_ = security::text_of(own.end);
  const std::string who = own.authority
                              ? fmt::format("the authority {}", fs::path(own.file).filename().string())
                              : fmt::format("the identity of this {}", settings_.role);
  std::vector<Expiry::Date> dates{{who, own.end, true, true}};
  // Keys that were made together end together, and are told of in one sentence.
  for (const auto& [prefix, identity] : identities_) {
    if (identity.cell != settings_.cell || identity.role == settings_.role || !identity.end) continue;
    const auto same = std::find_if(dates.begin() + 1, dates.end(), [&](const Expiry::Date& date) {
      return std::chrono::abs(date.end - *identity.end) < std::chrono::hours(1);
    });
    if (same == dates.end()) {
      dates.push_back({"the identity of " + identity.role, *identity.end, leads(identity.role), false});
    } else {
      same->who += ", " + identity.role;
      same->end = std::min(same->end, *identity.end);
      same->leads = same->leads || leads(identity.role);
    }
  }
  expiry_ = Expiry(std::move(dates));
}

void Protection::apply(eprosima::fastdds::dds::DomainParticipantQos& qos) const {
  // Announcements are clear: who we are is told to those who are authenticated (Participant).
  qos.name("");
  qos.user_data().data_vec({});
  const fs::path store = settings_.security;
  const security::RoleFiles own = security::role_files(store, settings_.cell, settings_.role);
  auto& properties = qos.properties().properties();
  const auto set = [&](const std::string& name, const std::string& value) {
    properties.emplace_back(name, value);
  };
  const auto file = [&](const std::string& name, const fs::path& path) {
    set(name, "file://" + path.string());
  };
  const std::string identity = "dds.sec.auth.builtin.PKI-DH.";
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  file(identity + "identity_ca", store / "identity_ca.pem");
  file(identity + "identity_certificate", own.certificate);
  file(identity + "private_key", own.key);
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  file(access + "permissions_ca", store / "permissions_ca.pem");
  file(access + "governance", security::governance_file(store, settings_.wan));
  file(access + "permissions", own.permissions);
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  qos.allocation().participants.maximum = kMostParticipants;
}

SiteTable Protection::sites() const {
  std::vector<SiteTable::Row> rows;
  for (const auto& [prefix, identity] : identities_) rows.push_back({prefix, identity.site});
  return SiteTable(std::move(rows));
}

const Protection::Identity* Protection::identity(const Key& prefix) const {
  security::SubjectPrefix subject;
  std::copy_n(prefix.begin(), subject.size(), subject.begin());
  const auto found = identities_.find(subject);
  return found == identities_.end() ? nullptr : &found->second;
}

std::string Protection::otherwise() const {
  std::vector<std::string> others;
  for (const security::SubjectPrefix& subject : gate_->otherwise(monotonic_ns())) {
    const Identity& one = identities_.at(subject);
    if (one.cell == settings_.cell) others.push_back(one.role);
  }
  if (others.empty()) return "";
  return fmt::format("messages of {} of cell '{}' are {}, so they are not heard here: {}",
                     fmt::join(others, ", "), settings_.cell,
                     settings_.wan ? "signed and not encrypted" : "encrypted",
                     settings_.wan ? "leave --wan out, or give it to all processes"
                                   : "give this process --wan, too, or leave it out everywhere");
}

bool Protection::fits(const Key& prefix, const PresenceMessage& presence) const {
  const Identity* const known = identity(prefix);
  return known != nullptr && known->cell == presence.cell && known->role == presence.role &&
         (!known->end || *known->end > std::chrono::system_clock::now());
}

std::string Protection::sentence() const {
  if (on())
    return fmt::format(
        "secured: messages are {}, and only who has keys of cell '{}' is heard; the keys end on {}",
        settings_.wan ? "encrypted" : "signed", settings_.cell, until_);
  if (!settings_.outside && !inner_addresses().empty())
    return "not secured, so it works within this computer alone: --security DIR opens it to the network, "
           "--insecure "
           "does so for whoever is there";
  return "not secured: whoever reaches this network can command it (--security DIR)";
}

std::vector<std::string> Protection::dates() {
  const security::Time now = std::chrono::system_clock::now();
  lets_go_.store(expiry_.lets_go(now), std::memory_order_relaxed);
  return expiry_.due(now);
}

std::string Protection::ended() const { return expiry_.ended(std::chrono::system_clock::now()); }

}  // namespace telekerf::bus
