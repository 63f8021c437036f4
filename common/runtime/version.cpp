// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/version.h"

namespace telekerf {

const char* const kVersion = TELEKERF_VERSION;

}  // namespace telekerf
