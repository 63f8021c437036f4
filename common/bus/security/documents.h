// SPDX-License-Identifier: Apache-2.0
// Governance and permissions of DDS Security 1.1: their text, their signature, and what is read back from
// them.
#pragma once

#include <openssl/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/security/roles.h"

namespace telekerf::security {

/// How all messages of a domain are protected: against whoever is none of us, and against a reader that signs
/// as the writer that it hears. `wan`: encrypted as well.
std::string governance_text(bool wan);

/// What a role may. The library reads the dates as local time.
std::string permissions_text(const std::string& cell, const Role& role,
                             std::chrono::system_clock::time_point begin,
                             std::chrono::system_clock::time_point end);

/// S/MIME with a signature of its own beside the text; empty: it could not be made.
std::string signed_document(const std::string& text, X509* certificate, EVP_PKEY* key);
/// Its text, if exactly this authority has signed it.
std::optional<std::string> verified_document(const std::filesystem::path& file, X509* authority);

/// A rule of permissions: topics that may be published (or subscribed), and where.
struct Rule {
  bool publish = false;
  std::vector<std::string> topics;
  std::vector<std::string> partitions;
  int highest_domain = 0;
};
struct Grant {
  std::string subject;
  std::string not_before, not_after;  ///< 2026-11-29T10:00:00
  std::vector<Rule> rules;
};
/// nullopt: no permissions.
std::optional<std::vector<Grant>> read_permissions(const std::string& text);

struct Governance {
  int highest_domain = 0;
  bool join_access_control = false;
  std::string rtps, discovery, liveliness;  ///< kinds of protection
  std::string topics;                       ///< expression of the first topic rule, and its kinds
  std::string metadata, data;
  bool topic_access_control = false;
};
/// nullopt: no governance.
std::optional<Governance> read_governance(const std::string& text);

/// As the library reads it here: local time, whatever zone it names. nullopt: no date.
std::optional<std::chrono::system_clock::time_point> local_time(const std::string& date);

}  // namespace telekerf::security
