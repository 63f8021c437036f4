// SPDX-License-Identifier: Apache-2.0
// What of the command stream can change between two engagements, and how an operator asks for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "common/protocol/messages.h"
#include "common/runtime/bounds.h"

namespace telekerf::master {

struct StationSettings;

inline constexpr Bounds kBlockSamples{.min = 4, .max = 64};
inline constexpr Bounds kKeptCoefficients{.min = 1, .max = 64};
inline constexpr Bounds kCopies{.min = 0, .max = 7};

/// Law, estimator and codec by the rows of their tables (law.h, estimators.h, codec_table.h). As large as a
/// word, so that it is handed from thread to thread whole.
struct StreamChoice {
  std::uint8_t law = 0;
  std::uint8_t estimator = 0;
  std::uint8_t codec = 0;
  std::uint8_t block = 16;  ///< samples a block
  std::uint8_t keep = 4;    ///< coefficients kept a block and axis
  std::uint8_t redundancy = 1;
  std::uint8_t unused[2] = {};
  bool operator==(const StreamChoice&) const = default;

  /// "law local", "block 32", ...: the words of the settings, and of their values. A literal that says why
  /// nothing comes of them; null: it is done. Neither allocates nor throws.
  const char* change(std::string_view words) noexcept;
};

/// As the settings have it, and the settings with it.
StreamChoice choice_of(const StationSettings& settings);
StationSettings with_choice(StationSettings settings, const StreamChoice& choice);

/// Events are heard in the control loop; the stream that they ask for is made in the thread that prepares
/// contours.
class StreamRequests {
 public:
  explicit StreamRequests(const StreamChoice& started) noexcept : in_force_(started), wanted_(started) {}

  static constexpr const char* kCannotBeMade =
      "refused: this codec does not go with this block and redundancy at this rate; law, estimator and codec "
      "stay "
      "(the master's output says what is wrong)";
  /// What holds when an event comes.
  struct Situation {
    bool stopped = false;
    bool led = false;  ///< the slave follows this master, or is to
    bool beam_on = false;
  };
  static bool concerns(const EventMessage& event) noexcept {
    return event.kind == EventMessage::Kind::kSetStream;
  }
  /// A literal: why nothing comes of it; null: it is taken up. Wait-free.
  const char* hear(const EventMessage& event, const Situation& now) noexcept;
  /// Another stream is wanted than the one in force: nobody may engage before it is there. Wait-free.
  bool pending() const noexcept { return !(wanted_.load() == in_force_.load()); }
  /// A stream of this choice was made: is it the one that is waited for? Then it is in force. Wait-free.
  bool grant(const StreamChoice& made) noexcept;
  /// Who has asked for a stream that could not be made, once; 0: nobody, or none was. Wait-free.
  std::uint32_t take_refused() noexcept { return refused_.exchange(false) ? asker_ : 0U; }

  /// For either thread.
  StreamChoice in_force() const noexcept { return in_force_.load(); }
  StreamChoice wanted() const noexcept { return wanted_.load(); }
  /// It cannot be made: the one in force is wanted again, unless another was asked for meanwhile.
  void refuse(StreamChoice choice) noexcept {
    if (wanted_.compare_exchange_strong(choice, in_force_.load())) refused_.store(true);
  }

 private:
  std::atomic<StreamChoice> in_force_;
  std::atomic<StreamChoice> wanted_;
  static_assert(std::atomic<StreamChoice>::is_always_lock_free);
  std::atomic<bool> refused_{false};
  std::uint32_t asker_ = 0;  ///< the loop's
};

}  // namespace telekerf::master
