// SPDX-License-Identifier: Apache-2.0
#include "common/codec/errors.h"

namespace telekerf::codec {

const char* to_string(CodecError error) noexcept {
  switch (error) {
    case CodecError::kNotFinite:
      return "not finite";
    case CodecError::kOutOfRange:
      return "out of range";
    case CodecError::kWrongSize:
      return "wrong size of block";
    case CodecError::kNoRoom:
      return "no room";
    case CodecError::kWrongVersion:
      return "wrong version";
    case CodecError::kTruncated:
      return "truncated packet";
    case CodecError::kMalformed:
      return "malformed packet";
    case CodecError::kReplayed:
      return "replayed packet";
  }
  return "unknown";
}

}  // namespace telekerf::codec
