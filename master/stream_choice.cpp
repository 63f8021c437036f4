// SPDX-License-Identifier: Apache-2.0
#include "master/stream_choice.h"

#include <charconv>
#include <optional>

#include "master/law.h"
#include "master/observer/estimators.h"
#include "master/station_settings.h"

namespace telekerf::master {
namespace {

template <typename Value>
std::optional<std::uint8_t> index_of(const EnumTable<Value>& table, std::string_view word) noexcept {
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    if (table.rows()[row].word == word) return static_cast<std::uint8_t>(row);
  }
  return std::nullopt;
}

template <typename Value>
std::uint8_t index_of(const EnumTable<Value>& table, const Value& value) noexcept {
  return index_of(table, table.word(value)).value_or(0);
}

std::optional<std::uint8_t> number_in(std::string_view text, const Bounds& bounds) noexcept {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, wrong] = std::from_chars(text.data(), end, number);
  if (wrong != std::errc() || rest != end || number < bounds.min || number > bounds.max) return std::nullopt;
  return static_cast<std::uint8_t>(number);
}

}  // namespace

const char* StreamChoice::change(std::string_view words) noexcept {
  const std::size_t space = words.find(' ');
  const std::string_view word = words.substr(0, space);
  const std::string_view rest = space == words.npos ? std::string_view() : words.substr(space + 1);
  const auto put = [](std::uint8_t& place, std::optional<std::uint8_t> value, const char* refusal) {
    place = value.value_or(place);
    return value ? nullptr : refusal;
  };
  if (word == "law")
    return put(law, index_of(kLaws, rest), "refused: no law of that name; telekerf-master --help has them");
  if (word == "estimator")
    return put(estimator, index_of(kEstimators, rest),
               "refused: no estimator of that name; telekerf-master --help has them");
  if (word == "codec")
    return put(codec, index_of(codec::kCodecs, rest),
               "refused: no codec of that name; telekerf-master --help has them");
  if (word == "block")
    return put(block, number_in(rest, kBlockSamples), "refused: block is a whole number within [4, 64]");
  if (word == "keep")
    return put(keep, number_in(rest, kKeptCoefficients), "refused: keep is a whole number within [1, 64]");
  if (word == "redundancy")
    return put(redundancy, number_in(rest, kCopies), "refused: redundancy is a whole number within [0, 7]");
  return "refused: while the master runs law, estimator, codec, block, keep and redundancy can change; rates "
         "and all "
         "else are set when it starts";
}

StreamChoice choice_of(const StationSettings& settings) {
  const CommandStreamSettings& command = settings.node.command;
  return {.law = index_of(kLaws, command.law),
          .estimator = index_of(kEstimators, command.observer.estimator),
          .codec = index_of(codec::kCodecs, settings.codec),
          .block = static_cast<std::uint8_t>(command.codec.block),
          .keep = static_cast<std::uint8_t>(command.codec.keep),
          .redundancy = static_cast<std::uint8_t>(command.codec.redundancy)};
}

StationSettings with_choice(StationSettings settings, const StreamChoice& choice) {
  CommandStreamSettings& command = settings.node.command;
  command.law = kLaws.rows()[choice.law].value;
  command.observer.estimator = kEstimators.rows()[choice.estimator].value;
  settings.codec = codec::kCodecs.rows()[choice.codec].value;
  command.codec.block = choice.block;
  command.codec.keep = choice.keep;
  command.codec.redundancy = choice.redundancy;
  return settings;
}

const char* StreamRequests::hear(const EventMessage& event, const Situation& now) noexcept {
  if (now.stopped) return "refused while stopped: law, estimator and codec stay before the stop is cleared";
  if (now.led) return "refused: law, estimator and codec change between two engagements; disengage first";
  if (now.beam_on) return "refused: law, estimator and codec stay while the beam is on; disengage first";
  StreamChoice next = wanted();  // with what is being made already
  if (const char* const refusal = next.change(event.text)) return refusal;
  asker_ = event.epoch;
  wanted_.store(next);
  return nullptr;
}

bool StreamRequests::grant(const StreamChoice& made) noexcept {
  if (!(made == wanted()) || !pending()) return false;
  in_force_.store(made);
  return true;
}

}  // namespace telekerf::master
