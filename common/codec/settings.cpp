// SPDX-License-Identifier: Apache-2.0
#include "common/codec/settings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/codec/dct.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

constexpr std::array<std::pair<CodecKind, const char*>, kCodecKinds> kNames{{
    {CodecKind::kSdct, "sdct"},
    {CodecKind::kRaw, "batched"},
    {CodecKind::kTruncatedDct, "truncated"},
    {CodecKind::kDeadband, "deadband"},
    {CodecKind::kWeber, "weber"},
    {CodecKind::kDpcm, "dpcm"},
}};
constexpr const char* kRawName = "raw";

template <typename Number>
void require(const char* name, Number value, Number min, Number max) {
  if (value >= min && value <= max) return;
  throw StartupError(fmt::format("codec: {} = {}: must lie within [{}, {}]", name, value, min, max));
}

}  // namespace

int smallest_block(CodecKind kind) noexcept {
  return kind == CodecKind::kSdct || kind == CodecKind::kTruncatedDct ? kMinTransform : 1;
}

StreamSettings StreamSettings::validated() const {
  require("block", block, smallest_block(kind), kMaxBlock);
  require("keep", keep, 1, kMaxBlock);
  require("redundancy", redundancy, 0, kMaxRedundancy);
  require("max_rms", max_rms, 0.0, 1e6);
  require("quantum", quantum, 1e-15, 1e6);
  require("threshold", threshold, 0.0, 1e6);
  require("axes", axes, 1, 3);
  require("sample_period_ns", sample_period_ns, std::uint32_t{1000}, std::uint32_t{1'000'000'000});
  StreamSettings settings = *this;
  if (settings.keep > settings.block) settings.keep = settings.block;
  return settings;
}

StreamSettings with_codec(StreamSettings settings, const std::string& name) {
  if (name == kRawName) {
    settings.kind = CodecKind::kRaw;
    settings.block = 1;
    settings.redundancy = 0;
    return settings;
  }
  std::string known = kRawName;
  for (const auto& [kind, word] : kNames) {
    known += ", " + std::string(word);
    if (name != word) continue;
    settings.kind = kind;
    return settings;
  }
  throw StartupError(fmt::format("codec = {}: must be one of {}", name, known));
}

std::string codec_name(const StreamSettings& settings) {
  return settings.kind == CodecKind::kRaw && settings.block == 1 ? kRawName : to_string(settings.kind);
}

const char* to_string(CodecKind kind) noexcept {
  for (const auto& [known, word] : kNames) {
    if (known == kind) return word;
  }
  return "unknown";
}

std::vector<std::string> codec_names() {
  std::vector<std::string> names{kRawName};
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

}  // namespace telekerf::codec
