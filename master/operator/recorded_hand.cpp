// SPDX-License-Identifier: Apache-2.0
#include "master/operator/recorded_hand.h"

#include <algorithm>
#include <utility>

namespace telekerf::master {

RecordedHand::RecordedHand(std::vector<MasterRow> rows) : rows_(std::move(rows)) {
  const auto first =
      std::find_if(rows_.begin(), rows_.end(), [](const MasterRow& row) { return row.guided; });
  next_ = static_cast<std::size_t>(first - rows_.begin());
}

OperatorSample RecordedHand::sample(std::int64_t /*now_ns*/) noexcept {
  if (!guided_ || next_ >= rows_.size()) return {};
  const MasterRow& row = rows_[next_++];
  if (!row.guided) return {};
  return {.trigger = row.button, .held = true, .force_n = row.hand_n};
}

std::unique_ptr<OperatorInput> open_recorded_hand(std::string_view rest) {
  return std::make_unique<RecordedHand>(read_csv(std::string(rest), master_columns()));
}

std::string validate_recorded_hand(std::string_view rest) {
  return rest.empty() ? "needs a file: recorded:DIR/master.csv, as --record leaves it" : "";
}

}  // namespace telekerf::master
