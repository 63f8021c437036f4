// SPDX-License-Identifier: Apache-2.0
// Any bytes into what restores blocks: no crash, no read out of range, nothing restored that no sender says,
// and a block that is refused leaves nothing behind. The first byte chooses the stream, the sender, and what
// the rest is: the block's octets, or what a block says, which then gets a right checksum. Links to
// libFuzzer, or to fuzz_blocks_bounded.cpp.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "common/protocol/contract_version.h"
#include "common/protocol/header_compression.h"

namespace {

using namespace telekerf;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const CommandBlock& block) {
  require(block.payload.size <= Payload::kCapacity);
  require(block.law <= Law::kRemoteAcceleration);
}
void check(const StateBlock& block) {
  require(block.payload.size <= Payload::kCapacity && block.force.size <= Payload::kCapacity);
  require(block.interlock <= kLastInterlock && block.mode <= SlaveMode::kStopped &&
          block.reason <= HoldReason::kStopped);
}

constexpr SenderKey kOwn{1, 2, 3};

/// A stream of its own, one block a call, that has to come back whatever stands between.
template <class Block>
class Witness {
 public:
  void goes_on(HeaderDecompressor<Block>& receiver) {
    Block block;
    block.sequence = ++number_;
    block.sample_period_ns = 1'000'000;
    block.sent_ns = 16'000'000LL * number_;
    block.anchor.position_m.x() = kGrid_m * (number_ % 1000);
    const auto bytes = sender_.compress(block, kContractVersion, room_);
    Block back;
    require(receiver.restore(bytes, kOwn, kContractVersion, back) == Verdict::kGood);
    require(back.sequence == block.sequence && back.sent_ns == block.sent_ns &&
            back.anchor.position_m == block.anchor.position_m);
  }

 private:
  static constexpr double kGrid_m = 0x1p-24;
  HeaderCompressor<Block> sender_;
  std::array<std::uint8_t, kMaxStateBytes> room_{};
  std::uint32_t number_ = 0;
};

template <class Block>
void feed(std::span<const std::uint8_t> bytes, const SenderKey& sender) {
  static HeaderDecompressor<Block> receiver;
  static Witness<Block> witness;
  witness.goes_on(receiver);
  Block block;
  const Verdict verdict = receiver.restore(bytes, sender, kContractVersion, block);
  if (verdict == Verdict::kGood) {
    check(block);
    require(std::isfinite(block.beta) && block.anchor.position_m.allFinite() &&
            block.anchor.velocity_m_per_s.allFinite());
  }
  (void)contract_of_block(bytes);
  if (verdict == Verdict::kGood && sender == kOwn) {  // another stream under the same name
    receiver = {};
    witness = {};
  }
  witness.goes_on(receiver);
}

void fill(ByteReader& in, CommandBlock& block) {
  block.law = static_cast<Law>(in.get(1));
  block.engaged_before = static_cast<std::uint8_t>(in.get(1) & 0x7F);
}
void fill(ByteReader& in, StateBlock& block) {
  block.interlock = static_cast<Interlock>(in.get(1));
  block.mode = static_cast<SlaveMode>(in.get(1));
  block.reason = static_cast<HoldReason>(in.get(1));
  block.applied_tick = in.get(8);
  block.applied_age_ticks = static_cast<std::uint32_t>(in.get(4));
  block.playout_ticks = static_cast<std::int32_t>(in.get_signed(4));
  block.echo_received_ns = in.get_signed(8);
}

/// Sealed by the sending end, whatever it says.
template <class Block>
void feed_sealed(std::span<const std::uint8_t> bytes, const SenderKey& sender) {
  static HeaderCompressor<Block> compressor;
  ByteReader in(bytes);
  Block block;
  block.sequence = static_cast<std::uint32_t>(in.get(4));
  block.sample_period_ns = static_cast<std::uint32_t>(in.get(4));
  block.ticks_per_sample = static_cast<std::uint16_t>(in.get(2));
  block.first_tick = in.get(8);
  block.beta = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(in.get(4))));
  block.sent_ns = in.get_signed(8);
  block.echo_sequence = static_cast<std::uint32_t>(in.get(4));
  block.echo_sent_ns = in.get_signed(8);
  for (int i = 0; i < 3; ++i) {
    block.anchor.position_m[i] = static_cast<double>(in.get_signed(4)) * 0x1p-24;
    block.anchor.velocity_m_per_s[i] = static_cast<double>(in.get_signed(4)) * 0x1p-16;
  }
  fill(in, block);
  const auto payload = in.good() ? in.rest() : std::span<const std::uint8_t>{};
  block.payload.size = static_cast<std::uint16_t>(std::min<std::size_t>(payload.size(), Payload::kCapacity));
  std::copy_n(payload.begin(), block.payload.size, block.payload.bytes.begin());
  std::array<std::uint8_t, kMaxStateBytes> room{};
  feed<Block>(compressor.compress(block, kContractVersion, room), sender);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // An exact copy: a read behind the block is a read behind the allocation.
  const auto bytes = std::make_unique<std::uint8_t[]>(size - 1);
  for (std::size_t i = 1; i < size; ++i) bytes[i - 1] = data[i];
  const std::span<const std::uint8_t> block(bytes.get(), size - 1);
  const SenderKey sender = (data[0] & 2) != 0 ? kOwn : SenderKey{10};  // damaged under way, or a stranger's
  switch (data[0] & 5) {
    case 0:
      feed<StateBlock>(block, sender);
      break;
    case 1:
      feed<CommandBlock>(block, sender);
      break;
    case 4:
      feed_sealed<StateBlock>(block, SenderKey{20});
      break;
    default:
      feed_sealed<CommandBlock>(block, SenderKey{20});
  }
  return 0;
}
