// SPDX-License-Identifier: Apache-2.0
#include "common/codec/settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/codec/baselines/raw.h"
#include "common/codec/codec_table.h"
#include "common/codec/dct.h"
#include "common/protocol/payload.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

template <typename Number>
void require(const char* name, Number value, Number min, Number max) {
  if (value >= min && value <= max) return;
  throw configuration_error(fmt::format("codec: {} = {}: must lie within [{}, {}]", name, value, min, max));
}

}  // namespace

StreamSettings StreamSettings::validated() const {
  const AxisCodec* const codec = find_codec(kind);
  if (codec == nullptr)
    throw configuration_error(fmt::format("codec: there is none of number {}", static_cast<int>(kind)));
  require("block", block, codec->min_block, kMaxBlock);
  require("keep", keep, 1, kMaxBlock);
  if (codec->min_block > 1 && keep > block) {
    throw configuration_error(
        fmt::format("codec: keep = {}: a block of {} samples has {} coefficients; keep no more than these",
                    keep, block, block));
  }
  require("redundancy", redundancy, 0, kMaxRedundancy);
  require("max_rms", max_rms, 0.0, 1e6);
  require("quantum", quantum, 1e-15, 1e6);
  require("threshold", threshold, 0.0, 1e6);
  require("axes", axes, 1, 3);
  require("sample_period_ns", sample_period_ns, std::uint32_t{1000}, std::uint32_t{1'000'000'000});
  if (const int bytes = (redundancy + 1) * axes * block * static_cast<int>(sizeof(float));
      kind == kRaw && bytes + 64 > static_cast<int>(Payload::kCapacity)) {
    throw configuration_error(
        fmt::format("codec: redundancy = {}: {} blocks of {} samples, {} axes of 4 bytes each, do not fit "
                    "into a payload of {} "
                    "bytes; choose a smaller block, fewer copies or another codec",
                    redundancy, redundancy + 1, block, axes, Payload::kCapacity));
  }
  StreamSettings settings = *this;
  settings.keep = std::min(settings.keep, settings.block);
  return settings;
}

StreamSettings with_codec(StreamSettings settings, const std::string& name) {
  const auto choice = kCodecs.find(name);
  if (!choice)
    throw configuration_error(
        fmt::format("codec = {}: must be one of {}", name, fmt::join(codec_names(), ", ")));
  return with_codec(settings, *choice);
}

std::vector<std::string> codec_names() {
  std::vector<std::string> names;
  for (const auto& row : kCodecs) names.emplace_back(row.word);
  return names;
}

}  // namespace telekerf::codec
