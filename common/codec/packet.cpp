// SPDX-License-Identifier: Apache-2.0
#include "common/codec/packet.h"

#include "common/codec/codec_table.h"
#include "common/protocol/payload.h"

namespace telekerf::codec {
namespace {

constexpr int kExponentBias = 256;

// Exp-Golomb orders of what the stream has been like.
constexpr int kCountOrder = 2;
constexpr int kStepOrder = 2;
constexpr int kLevelOrder = 3;
constexpr int kValueOrder = 2;
// Their bounds.
constexpr std::uint64_t kMaxCount = 63;
constexpr std::uint64_t kMaxStep = 31;
constexpr std::uint64_t kMaxLevelOrder = 31;
constexpr std::uint64_t kMaxValueOrder = 15;

constexpr std::size_t kBlocksByte = kPayloadPrefixBytes;  // its highest three bits

}  // namespace

void write_head(BitWriter& out, const PacketHead& head) noexcept {
  out.bits(kPacketVersion, 4);
  out.bits(static_cast<std::uint64_t>(head.kind), 4);
  out.bits(static_cast<std::uint64_t>(head.redundancy), 3);
  out.bits(head.anchored ? 1 : 0, 1);
  out.bits(head.adaptive ? 1 : 0, 1);
  out.bits(head.integrated ? 1 : 0, 1);
  out.bits(static_cast<std::uint64_t>(head.axes), 2);
  out.bits(static_cast<std::uint64_t>(head.block - 1), 6);
  out.bits(0, 1);
  const int biased_exponent = head.quantum_exponent + kExponentBias;
  out.bits(static_cast<std::uint64_t>(biased_exponent), 9);
  out.bits(head.sample_period_ns, 32);
  out.bits(head.sequence, 16);
  out.bits(static_cast<std::uint64_t>(head.blocks - 1), 3);
  out.golomb(static_cast<std::uint64_t>(head.model.count), kCountOrder);
  if (head.adaptive) out.golomb(static_cast<std::uint64_t>(head.model.step_offset), kStepOrder);
  out.golomb(static_cast<std::uint64_t>(head.model.level_order), kLevelOrder);
  out.golomb(static_cast<std::uint64_t>(head.model.value_order), kValueOrder);
}

void patch_blocks(std::span<std::uint8_t> packet, int blocks) noexcept {
  packet[kBlocksByte] =
      static_cast<std::uint8_t>((packet[kBlocksByte] & 0x1FU) | (static_cast<unsigned>(blocks - 1) << 5));
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
  head.redundancy = static_cast<int>(in.bits(3));
  head.anchored = in.bit();
  head.adaptive = in.bit();
  head.integrated = in.bit();
  head.axes = static_cast<int>(in.bits(2));
  head.block = static_cast<int>(in.bits(6)) + 1;
  const bool reserved = in.bit();
  head.quantum_exponent = static_cast<int>(in.bits(9)) - kExponentBias;
  head.sample_period_ns = static_cast<std::uint32_t>(in.bits(32));
  head.sequence = static_cast<std::uint16_t>(in.bits(16));
  head.blocks = static_cast<int>(in.bits(3)) + 1;
  const auto count = in.golomb(kCountOrder);
  const auto step = head.adaptive ? in.golomb(kStepOrder) : 0;
  const auto level_order = in.golomb(kLevelOrder);
  const auto value_order = in.golomb(kValueOrder);
  if (in.truncated()) return tl::unexpected(CodecError::kTruncated);
  const bool known = count <= kMaxCount && step <= kMaxStep && level_order <= kMaxLevelOrder &&
                     value_order <= kMaxValueOrder;
  const bool sized = head.block >= codec->min_block && head.axes >= 1;
  if (in.malformed() || reserved || !known || !sized || head.blocks > head.redundancy + 1 ||
      (head.integrated && (head.adaptive || !codec->transforms)) || head.sample_period_ns == 0 ||
      head.sample_period_ns > 1'000'000'000) {
    return tl::unexpected(CodecError::kMalformed);
  }
  head.model = {static_cast<int>(count), static_cast<int>(step), static_cast<int>(level_order),
                static_cast<int>(value_order)};
  return head;
}

bool is_finite(const Trend& trend) noexcept {
  return trend.value.allFinite() && trend.slope_per_sample.allFinite();
}

}  // namespace telekerf::codec
