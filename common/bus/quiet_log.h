// SPDX-License-Identifier: Apache-2.0
// What the middleware says of errors, a few lines a second: whoever forges messages shall not fill a disk.
// Inside the bus only.
#pragma once

namespace telekerf::bus {

/// From now on, for the whole process, once.
void quiet_log();

}  // namespace telekerf::bus
