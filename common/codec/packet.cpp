// SPDX-License-Identifier: Apache-2.0
#include "common/codec/packet.h"

#include "common/codec/codec_table.h"

namespace telekerf::codec {
namespace {

constexpr int kExponentBias = 256;
constexpr int kPeriodOrder = 20;

}  // namespace

void write_head(BitWriter& out, const PacketHead& head) noexcept {
  out.bits(kPacketVersion, 4);
  out.bits(static_cast<std::uint64_t>(head.kind), 4);
  out.bits(static_cast<std::uint64_t>(head.blocks - 1), 3);
  out.bits(static_cast<std::uint64_t>(head.redundancy), 3);
  out.bits(head.anchored ? 1 : 0, 1);
  out.bits(head.adaptive ? 1 : 0, 1);
  out.bits(static_cast<std::uint64_t>(head.block - 1), 6);
  const int biased_exponent = head.quantum_exponent + kExponentBias;
  out.bits(static_cast<std::uint64_t>(biased_exponent), 9);
  out.bits(static_cast<std::uint64_t>(head.axes), 2);
  out.bits(head.sequence, 16);
  out.bits(static_cast<std::uint64_t>(head.model.count), 6);
  out.bits(static_cast<std::uint64_t>(head.model.step_offset), 5);
  out.bits(static_cast<std::uint64_t>(head.model.level_order), 5);
  out.bits(static_cast<std::uint64_t>(head.model.value_order), 4);
  out.golomb(head.sample_period_ns, kPeriodOrder);
}

void patch_blocks(std::span<std::uint8_t> packet, int blocks) noexcept {
  packet[1] = static_cast<std::uint8_t>((packet[1] & 0x1FU) | (static_cast<unsigned>(blocks - 1) << 5));
}

tl::expected<PacketHead, CodecError> read_head(BitReader& in) noexcept {
  const auto version = in.bits(4);
  const auto kind = in.bits(4);
  if (in.truncated()) return tl::unexpected(CodecError::kTruncated);
  if (version != kPacketVersion) return tl::unexpected(CodecError::kWrongVersion);
  const AxisCodec* const codec = find_codec(static_cast<CodecKind>(kind));
  if (codec == nullptr) return tl::unexpected(CodecError::kMalformed);
  PacketHead head;
  head.kind = codec->kind;
  head.blocks = static_cast<int>(in.bits(3)) + 1;
  head.redundancy = static_cast<int>(in.bits(3));
  head.anchored = in.bit();
  head.adaptive = in.bit();
  head.block = static_cast<int>(in.bits(6)) + 1;
  head.quantum_exponent = static_cast<int>(in.bits(9)) - kExponentBias;
  head.axes = static_cast<int>(in.bits(2));
  head.sequence = static_cast<std::uint16_t>(in.bits(16));
  head.model.count = static_cast<int>(in.bits(6));
  head.model.step_offset = static_cast<int>(in.bits(5));
  head.model.level_order = static_cast<int>(in.bits(5));
  head.model.value_order = static_cast<int>(in.bits(4));
  const auto period = in.golomb(kPeriodOrder);
  if (in.truncated()) return tl::unexpected(CodecError::kTruncated);
  const bool sized = head.block >= codec->min_block && head.axes >= 1;
  if (in.malformed() || !sized || head.blocks > head.redundancy + 1 || period == 0 ||
      period > 1'000'000'000) {
    return tl::unexpected(CodecError::kMalformed);
  }
  head.sample_period_ns = static_cast<std::uint32_t>(period);
  return head;
}

bool is_finite(const Trend& trend) noexcept {
  return trend.value.allFinite() && trend.slope_per_sample.allFinite();
}

}  // namespace telekerf::codec
