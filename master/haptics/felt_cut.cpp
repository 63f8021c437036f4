// SPDX-License-Identifier: Apache-2.0
#include "master/haptics/felt_cut.h"

namespace telekerf::master {

void add_figures(const FeltCutStatistics& felt, Metrics& figures) {
  const double steps = static_cast<double>(std::max<std::uint64_t>(1, felt.steps));
  figures["felt_wished_rms_n"] = std::sqrt(felt.wished_n_squared / steps);
  figures["felt_rms_n"] = std::sqrt(felt.felt_n_squared / steps);
  figures["felt_held_back_share"] = static_cast<double>(felt.held_back) / steps;
  figures["felt_most_given_j"] = felt.most_given_j;
}

}  // namespace telekerf::master
