// SPDX-License-Identifier: Apache-2.0
#include "common/codec/settings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/codec/dct.h"
#include "common/runtime/refusal.h"

namespace telekerf::codec {
namespace {

constexpr std::array<std::pair<CodecKind, const char*>, 2> kNames{{
    {CodecKind::kSdct, "sdct"},
    {CodecKind::kRaw, "raw"},
}};

template <typename Number>
void require(const char* name, Number value, Number min, Number max) {
  if (value >= min && value <= max) return;
  throw Refusal(fmt::format("codec: {} = {}: must lie within [{}, {}]", name, value, min, max));
}

}  // namespace

StreamSettings StreamSettings::validated() const {
  const bool transforms = kind == CodecKind::kSdct;
  require("block", block, transforms ? kMinTransform : 1, kMaxBlock);
  require("keep", keep, 1, kMaxBlock);
  require("redundancy", redundancy, 0, kMaxRedundancy);
  require("max_rms", max_rms, 0.0, 1e6);
  require("quantum", quantum, 1e-15, 1e6);
  require("sample_period_ns", sample_period_ns, std::uint32_t{1000}, std::uint32_t{1'000'000'000});
  StreamSettings settings = *this;
  if (settings.keep > settings.block) settings.keep = settings.block;
  return settings;
}

CodecKind codec_kind(const std::string& name) {
  std::string known;
  for (const auto& [kind, word] : kNames) {
    if (name == word) return kind;
    known += (known.empty() ? "" : ", ") + std::string(word);
  }
  throw Refusal(fmt::format("codec = {}: must be one of {}", name, known));
}

const char* to_string(CodecKind kind) noexcept {
  for (const auto& [known, word] : kNames) {
    if (known == kind) return word;
  }
  return "unknown";
}

std::vector<std::string> codec_names() {
  std::vector<std::string> names;
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

}  // namespace telekerf::codec
