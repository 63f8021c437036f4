// SPDX-License-Identifier: Apache-2.0
// Which emergency stops are in force, by what was heard and quoted. Each has an owner, and only its owner
// ends it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/protocol/stop.h"

namespace telekerf {

/// Without thread, clock and bus; the order in which messages come, and how often, changes nothing.
class StopLatch {
 public:
  struct Entry {
    std::uint32_t number = 0;
    std::string source;  ///< empty: only its number was quoted so far
    std::string reason;
  };
  enum class Heard : std::uint8_t {
    kKnown,    ///< nothing new
    kStopped,  ///< another stop is in force
    kCleared,  ///< one less
    kRefused,  ///< a clear by somebody else than who stopped, or before that is known
  };

  Heard hear(const StopMessage& message);
  /// A stream of the other side carries this number.
  Heard quoted(std::uint32_t number);

  StopOrder order() const noexcept;
  const std::vector<Entry>& in_force() const noexcept { return in_force_; }
  /// Cleared lately, newest last.
  const std::vector<Entry>& cleared() const noexcept { return cleared_; }

  /// A line a stop, for a file that survives the process; and back. Lines that are none are left out.
  std::string text() const;
  static StopLatch from_text(const std::string& text);

 private:
  bool was_cleared(std::uint32_t number) const noexcept;

  static constexpr std::size_t kMost = 16;  ///< of each
  std::vector<Entry> in_force_;
  std::vector<Entry> cleared_;
};

}  // namespace telekerf
