// SPDX-License-Identifier: Apache-2.0
#include "common/codec/codec_table.h"

namespace telekerf::codec {

StreamSettings with_codec(StreamSettings settings, const CodecChoice& choice) {
  settings.kind = choice.codec->kind;
  if (choice.sample_by_sample) {
    settings.block = 1;
    settings.redundancy = 0;
  }
  return settings;
}

}  // namespace telekerf::codec
