// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/bounds.h"

#include <fmt/format.h>

#include <cmath>

namespace telekerf {

std::string complaint_about(double value, const Bounds& bounds) {
  if (!std::isfinite(value)) return "must be a finite number";
  if (value >= bounds.min && value <= bounds.max) return "";
  return fmt::format("must lie within [{:g}, {:g}]{}{}", bounds.min, bounds.max, *bounds.unit ? " " : "",
                     bounds.unit);
}

std::string range_text(const Bounds& bounds) {
  const std::string unit = *bounds.unit ? fmt::format(" {}", bounds.unit) : "";
  if (std::isfinite(bounds.min) && std::isfinite(bounds.max))
    return fmt::format("{:g} to {:g}{}", bounds.min, bounds.max, unit);
  if (std::isfinite(bounds.min)) return fmt::format("at least {:g}{}", bounds.min, unit);
  if (std::isfinite(bounds.max)) return fmt::format("at most {:g}{}", bounds.max, unit);
  return bounds.unit;
}

}  // namespace telekerf
