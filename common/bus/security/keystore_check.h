// SPDX-License-Identifier: Apache-2.0
// What the middleware would fail on without saying why, found beforehand.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace telekerf::security {

using Time = std::chrono::system_clock::time_point;

/// The life of an identity, of its permissions on this computer, or of an authority, whichever ends first.
struct Validity {
  Time begin, end;
  std::string file;        ///< that ends first
  bool authority = false;  ///< it is an authority's certificate
};

struct KeystoreReport {
  std::vector<std::string> faults;  ///< a sentence each: file, what is wrong, remedy
  std::vector<std::string> notes;   ///< no faults, but worth knowing: keys that are elsewhere
  int identities = 0;               ///< looked at
  std::optional<Validity> first_to_end;
};

/// Everything that lies in the store, at `now`.
KeystoreReport check_keystore(const std::filesystem::path& store, Time now);

/// What a process of this role needs.
KeystoreReport check_role(const std::filesystem::path& store, const std::string& cell,
                          const std::string& role, bool wan, Time now);

/// Until when this certificate is valid; nullopt: there is none.
std::optional<Time> certificate_end(const std::filesystem::path& file);

/// Whole days until `end`, rounded down; negative: over.
int days_left(Time end, Time now);
std::string text_of(Time time);

}  // namespace telekerf::security
