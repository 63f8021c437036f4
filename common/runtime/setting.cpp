// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/setting.h"

#include <algorithm>
#include <utility>

namespace telekerf {

TextForm device_form(const std::string& forms, std::function<std::string(const std::string&)> validate) {
  TextForm form;
  for (const char c : forms) {
    if (c != ' ') form.form += c == ',' ? '|' : c;
  }
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
