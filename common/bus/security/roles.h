// SPDX-License-Identifier: Apache-2.0
// Who may say and hear what in a secured cell, and how each is named in its certificate.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/site.h"

namespace telekerf::security {

/// A role has an identity of its own in each cell. A topic that is in neither list is closed to it.
struct Role {
  const char* name;  ///< folder of its keys
  Site site;
  std::vector<const char*> publishes;
  std::vector<const char*> subscribes;
};

std::span<const Role> roles();
/// The role whose identity a process uses; null: there is none of this name.
const Role* find_role(const std::string& name);

/// Topic of nothing but its writer's user data: who a process is, told through discovery that is encrypted.
inline constexpr const char* kPresenceTopic = "telekerf/presence";

/// What is wrong with a cell's name as a part of certificates and paths; empty: nothing.
std::string complaint_about_secured_cell(const std::string& cell);

/// The name in a role's certificate: the role, but for the peer, whose GUID has to be the lowest of the cell:
/// the side with the lower one begins the handshake, and another vendor's answer is not understood
/// (eclipse-cyclonedds/cyclonedds#1547).
std::string common_name(const std::string& cell, const std::string& role);

/// As permissions name it, RFC 2253: "CN=master,OU=cell-1,O=Telekerf".
std::string subject_of(const std::string& cell, const std::string& common_name);

/// First octets of the GUID prefix of whoever has proved to be this subject: one bit and 47 of the SHA-256 of
/// its name (DDS Security 1.1, 9.3.3).
using SubjectPrefix = std::array<std::uint8_t, 6>;
SubjectPrefix prefix_of(const std::string& cell, const std::string& common_name);

}  // namespace telekerf::security
