// SPDX-License-Identifier: Apache-2.0
// The operator of a recorded run once more, step by step from its first one, so that a run in virtual time
// comes out the same bit by bit. (recorded_hand.h begins where the constraint holds the tool, for other runs.)
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/recording/rows.h"
#include "master/operator/operator_input.h"

namespace telekerf::master {

/// Row n is the n-th step. At the end it lets go.
class ReplayedHand final : public OperatorInput {
 public:
  explicit ReplayedHand(std::vector<MasterRow> rows) : rows_(std::move(rows)) {}
  OperatorSample sample(std::int64_t /*now_ns*/) noexcept override {
    if (next_ >= rows_.size()) return {};
    const MasterRow& row = rows_[next_++];
    return {.trigger = row.button, .force_n = row.hand_n};
  }

 private:
  std::vector<MasterRow> rows_;
  std::size_t next_ = 0;
};

}  // namespace telekerf::master
