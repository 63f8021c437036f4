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

void refuse_unread(Settings& settings, const std::vector<std::string>& signals) {
  settings.not_with({"block", "redundancy"}, "codec", {"raw"});
  for (const std::string& signal : signals) {
    settings.not_with({signal + "max_rms"}, "codec", {"raw", "batched"});
    settings.not_with({signal + "keep"}, "codec", {"raw", "batched", "deadband", "weber", "dpcm"});
    settings.only_with({signal + "keep"}, signal + "max_rms", {"0"});
  }
}

}  // namespace telekerf::codec
