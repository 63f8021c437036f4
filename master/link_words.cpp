// SPDX-License-Identifier: Apache-2.0
#include "master/link_words.h"

#include <fmt/format.h>

namespace telekerf::master {
namespace {

constexpr std::chrono::milliseconds kLinkPatience{500};  ///< a single late block is no word worth
constexpr std::chrono::seconds kLinkAgain{5};

}  // namespace

std::string link_sentence(double age_s) {
  if (age_s < 0.0) return {};
  return fmt::format(
      "the link is too slow for the laser: commands are {:.2f} s old, there and back, when the slave applies "
      "them, "
      "and its --beam-age-s allows less; mend the link, or start the slave with a --beam-age-s above that "
      "(at most 2)",
      age_s);
}

std::string LinkWords::due(std::chrono::steady_clock::time_point now) {
  const double late_s = late_s_.load(std::memory_order_relaxed);
  if (late_s < 0.0) {
    const bool over = said_;
    said_ = false;
    since_ = now;
    return over ? "the link is fast enough for the laser again" : "";
  }
  if (now - since_ < kLinkPatience || (said_ && now < next_)) return {};
  said_ = true;
  next_ = now + kLinkAgain;
  return link_sentence(late_s);
}

}  // namespace telekerf::master
