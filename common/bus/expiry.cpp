// SPDX-License-Identifier: Apache-2.0
#include "common/bus/expiry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace telekerf::bus {
namespace {

using std::chrono::hours;
constexpr std::chrono::seconds kLettingGo{3};
constexpr const char* kRemedy = "./telekerf keys DIR --renew, copy, and restart";

}  // namespace

bool ends_too_soon(const security::Validity& validity, security::Time now) {
  const auto whole = validity.end - validity.begin;
  return validity.end - now < std::min<security::Time::duration>(hours(1), whole / 10);
}

std::vector<std::string> Expiry::due(security::Time now) {
  constexpr std::array<hours, 3> kBefore{hours(24 * 30), hours(24), hours(0)};
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < dates_.size(); ++i) {
    const Date& date = dates_[i];
    int reached = 0;
    for (const hours before : kBefore) reached += date.end - now <= before ? 1 : 0;
    if (reached <= said_[i]) continue;
    said_[i] = reached;
    const auto left = std::chrono::duration_cast<std::chrono::minutes>(date.end - now).count();
    sentences.push_back(
        reached == 3 ? fmt::format("{} has ended on {}: {}", date.who, security::text_of(date.end), kRemedy)
                     : fmt::format("{} ends on {}, in {}: {}", date.who, security::text_of(date.end),
                                   left >= 48 * 60 ? fmt::format("{} days", left / (24 * 60))
                                                   : fmt::format("{} h {} min", left / 60, left % 60),
                                   kRemedy));
  }
  return sentences;
}

bool Expiry::lets_go(security::Time now) const {
  return std::any_of(dates_.begin(), dates_.end(),
                     [&](const Date& date) { return date.leads && date.end - now <= kLettingGo; });
}

std::string Expiry::ended(security::Time now) const {
  for (const Date& date : dates_) {
    if (date.own && date.end <= now)
      return fmt::format("{} has ended on {}; {}", date.who, security::text_of(date.end), kRemedy);
  }
  return "";
}

}  // namespace telekerf::bus
