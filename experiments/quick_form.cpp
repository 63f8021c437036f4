// SPDX-License-Identifier: Apache-2.0
#include "experiments/quick_form.h"

#include <utility>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {

void QuickForm::add_quick(Settings& settings, std::vector<Shorter> shorter,
                          std::vector<std::string> whole_runs) {
  settings_ = &settings;
  shorter_ = std::move(shorter);
  whole_runs_ = std::move(whole_runs);
  std::string which;
  for (const Shorter& one : shorter_)
    which += fmt::format("{}{} {}", which.empty() ? "" : ", ", one.setting, one.value);
  settings.add("quick", quick,
               which.empty() ? "short form, as `all --quick` runs it; here it is the whole"
                             : "short form, as `all --quick` runs it; where not given: " + which);
}

void QuickForm::validate() const {
  if (!quick || settings_ == nullptr) return;
  const std::string given = fmt::format("\n{}", settings_->given_toml());
  const auto is_given = [&](const std::string& name) {
    return given.find(fmt::format("\n{} = ", name)) != given.npos;
  };
  for (const std::string& name : whole_runs_)
    if (is_given(name))
      throw usage_error(fmt::format("--{}: it is for figures of whole runs; leave out it or --quick", name));
  for (const Shorter& one : shorter_)
    if (!is_given(one.setting)) one.take();
}

}  // namespace telekerf::experiments
