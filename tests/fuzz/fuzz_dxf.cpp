// SPDX-License-Identifier: Apache-2.0
// libFuzzer entry for the DXF reader: clang++ -fsanitize=fuzzer,address.
#include <cstdint>

#include "tests/fuzz/vector_drawings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  telekerf::vision::try_reader({reinterpret_cast<const char*>(data), size}, false);
  return 0;
}
