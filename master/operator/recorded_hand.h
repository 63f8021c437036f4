// SPDX-License-Identifier: Apache-2.0
// The hand of an earlier run once more: force and button, row by row of its master.csv.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/rows.h"
#include "master/operator/operator_input.h"

namespace telekerf::master {

/// Begins with the first row that was guided, when the constraint holds the tool; rows are control steps. At
/// the end, and while nothing is guided, it lets go.
class RecordedHand final : public OperatorInput {
 public:
  explicit RecordedHand(std::vector<MasterRow> rows);
  OperatorSample sample(std::int64_t now_ns) noexcept override;
  void answer(const OperatorAnswer& answer) noexcept override { guided_ = answer.guided; }

 private:
  std::vector<MasterRow> rows_;
  std::size_t next_ = 0;
  bool guided_ = false;
};

/// `rest`: the file. Throws StartupError.
std::unique_ptr<OperatorInput> open_recorded_hand(std::string_view rest);
std::string validate_recorded_hand(std::string_view rest);

}  // namespace telekerf::master
