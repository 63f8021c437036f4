// SPDX-License-Identifier: Apache-2.0
// The folder with everything that a secured cell needs, made in one call.
//
//   identity_ca.pem .key       says who somebody is
//   permissions_ca.pem .key    says what they may: another authority, or an identity could sign its own
//   permissions
//                              (CVE-2023-24010)
//   governance.smime           how messages are protected: signed; governance_wan.smime: encrypted
//   cells/CELL/device.key      seals the datagrams of this cell's drive, laser and button
//                              (common/runtime/datagram_seal.h)
//   cells/CELL/ROLE/           cert.pem, key.pem, permissions.smime
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace telekerf::security {

inline constexpr int kHighestSecuredDomain =
    230;  // Cyclone DDS takes no higher one in governance and permissions
inline constexpr std::chrono::hours kDay{24};
inline constexpr std::chrono::hours kAuthorityLife{3650 * 24};

struct RoleFiles {
  std::filesystem::path certificate, key, permissions;
};
RoleFiles role_files(const std::filesystem::path& store, const std::string& cell, const std::string& role);
std::filesystem::path device_key_file(const std::filesystem::path& store, const std::string& cell);
std::filesystem::path governance_file(const std::filesystem::path& store, bool wan);
/// Cells that have keys in this store, in order.
std::vector<std::string> cells_of(const std::filesystem::path& store);

/// Makes it: authorities, governance, an identity for each role in each cell. What is valid is so from a day
/// (at most `life`) before now on: clocks differ. Files can be read by their owner alone. Throws
/// StartupError: a name, a folder that is not empty or cannot be written.
void make_keystore(const std::filesystem::path& store, const std::vector<std::string>& cells,
                   std::chrono::seconds life);

/// New identities and permissions from the authorities that are there, for all its cells and for `more`
/// cells. Each role's folder is replaced whole. An authority that would end before them is renewed as well:
/// whose certificates those were (their files); processes with the old ones and with the new ones do not hear
/// each other. Throws StartupError.
std::vector<std::filesystem::path> renew_keystore(const std::filesystem::path& store,
                                                  const std::vector<std::string>& more,
                                                  std::chrono::seconds life);

}  // namespace telekerf::security
