// SPDX-License-Identifier: Apache-2.0
// Governance and permissions of DDS Security 1.1: their text, their signature, and what is read back from
// them.
#pragma once

#include <openssl/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>
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

/// A rule of permissions: what it says of the topics that may be published (or subscribed), and where.
struct Rule {
  bool allow = true;  ///< false: a deny rule
  bool publish = false;
  std::vector<std::string> topics;
  std::vector<std::string> partitions;       ///< "" is the one without a name
  std::vector<std::pair<int, int>> domains;  ///< first and last
};
struct Grant {
  std::string subject;
  std::string not_before, not_after;  ///< 2026-11-29T10:00:00
  std::vector<Rule> rules;            ///< in their order
  std::string otherwise;              ///< its default
};
/// Permissions as the library wants them: every element in its place. Otherwise what is wrong, as "its
/// <grant> holds ...".
[[nodiscard]] tl::expected<std::vector<Grant>, std::string> read_permissions(const std::string& text);

/// The rule by which the library decides on `topic`: the first that names it, be it by a pattern; null: none,
/// so it is denied (Fast DDS 2.9, Permissions::check_create_datawriter()).
const Rule* deciding_rule(const Grant& grant, bool publish, const std::string& topic);

/// What `text` says otherwise than governance_text(wan), as "data_protection_kind ENCRYPT in place of NONE";
/// empty: nothing.
std::string difference_from_governance(const std::string& text, bool wan);

/// As the library reads it here: local time, whatever zone it names. nullopt: no date.
std::optional<std::chrono::system_clock::time_point> local_time(const std::string& date);

}  // namespace telekerf::security
