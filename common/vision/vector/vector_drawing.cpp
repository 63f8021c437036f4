// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

std::optional<double> metres_of(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMillimetre:
      return 1e-3;
    case LengthUnit::kCentimetre:
      return 1e-2;
    case LengthUnit::kMetre:
      return 1.0;
    case LengthUnit::kInch:
      return 25.4e-3;
    case LengthUnit::kFoot:
      return 0.3048;
    case LengthUnit::kPoint:
      return 25.4e-3 / 72.0;
    case LengthUnit::kMicrometre:
      return 1e-6;
    case LengthUnit::kFile:
      break;
  }
  return std::nullopt;
}

}  // namespace telekerf::vision
