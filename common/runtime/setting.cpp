// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/setting.h"

#include <algorithm>
#include <utility>

namespace telekerf {

TextForm device_form(const std::string& forms, std::function<std::string(const std::string&)> validate) {
  TextForm form{forms};
  for (std::size_t at = 0; (at = form.form.find(", ", at)) != std::string::npos; ++at)
    form.form.replace(at, 2, "|");
  form.complaint = std::move(validate);
  return form;
}

std::string Setting::flag() const {
  std::string dashed = "--";
  dashed += name;
  std::replace(dashed.begin(), dashed.end(), '_', '-');
  return dashed;
}

}  // namespace telekerf
