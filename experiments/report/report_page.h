// SPDX-License-Identifier: Apache-2.0
// report.html: claims, figures and commands in one file that needs nothing beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/report/judgement.h"
#include "experiments/report/manifest.h"
#include "experiments/report/result_store.h"

namespace telekerf::experiments {

struct ReportPage {
  const Manifest& manifest;
  const std::vector<Judged>& judged;
  const std::vector<Finished>& finished;
  std::uint64_t seed = 1;
  bool quick = false;
  std::string commit;
  std::vector<std::string> differences;  ///< from the run it is held against; empty with `against`: none
  std::string against;                   ///< name of that run; empty: none was named
  std::string other_conditions;          ///< seed or form that it had otherwise; empty: the same
  std::string made;  ///< the one line that depends on when and where; empty: there is none
};

/// The page's text. Throws StartupError if the template, Dygraphs or a figure cannot be read.
std::string report_page(const ReportPage& page);

/// When, on what machine, and how long each experiment took that was not there already.
std::string made_line(const std::vector<Finished>& finished);

}  // namespace telekerf::experiments
