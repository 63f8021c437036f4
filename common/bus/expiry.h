// SPDX-License-Identifier: Apache-2.0
// Identities end, and the middleware says nothing of it: a session goes on without them. So each process
// looks at its own and at its peers'. Pure rules; Participant knows the dates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/security/keystore_check.h"

namespace telekerf::bus {

/// Whether a work that begins now may not be brought to its end: less than an hour is left, or less than a
/// tenth of the whole life.
bool ends_too_soon(const security::Validity& validity, security::Time now);

/// What is to be said and done about dates.
class Expiry {
 public:
  struct Date {
    std::string who;  ///< "this master's identity"
    security::Time end;
    bool leads = false;  ///< an engagement needs it: the own one, the master's and the slave's
    bool own = false;
  };
  explicit Expiry(std::vector<Date> dates) : dates_(std::move(dates)), said_(dates_.size(), 0) {}

  /// A sentence for each that has come within 30 days or a day of its end since the last call, or reached it.
  std::vector<std::string> due(security::Time now);
  /// The first of what an engagement needs ends within this many seconds: it is to be let go in order.
  bool lets_go(security::Time now) const;
  /// The own one has ended, in a sentence; empty: it has not.
  std::string ended(security::Time now) const;

 private:
  std::vector<Date> dates_;
  std::vector<int> said_;  ///< warnings of each so far
};

}  // namespace telekerf::bus
