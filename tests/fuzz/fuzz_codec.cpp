// SPDX-License-Identifier: Apache-2.0
// Any bytes into the block decoder: no crash, no read out of range, nothing decoded that is not finite.
// The first byte chooses the trend; the rest is the packet. Links to libFuzzer, or to fuzz_codec_bounded.cpp.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "common/codec/decoder.h"

namespace {

using telekerf::Vec3;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const telekerf::codec::DecodedPacket& packet) {
  require(packet.blocks >= 1 && packet.blocks <= telekerf::codec::kMaxBlocks);
  require(packet.block_size >= 1 && packet.block_size <= telekerf::codec::kMaxBlock);
  for (int i = 0; i < packet.blocks; ++i) {
    const auto& block = packet.blocks_newest_first[static_cast<std::size_t>(i)];
    require(block.samples.size() == static_cast<std::size_t>(packet.block_size));
    for (const auto& sample : block.samples) require(sample.allFinite());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace telekerf::codec;
  static BlockDecoder decoder;
  if (size == 0) return 0;
  Trend trend;
  const double scale = (data[0] & 1) != 0 ? 1e-3 : 1e25;
  trend.value = Vec3(1, -2, 0.5) * scale * (data[0] >> 4);
  trend.slope_per_sample = Vec3(-0.1, 0.3, 1) * scale * (data[0] & 0xE);
  // An exact copy: a read behind the packet is a read behind the allocation.
  const auto bytes = std::make_unique<std::uint8_t[]>(size - 1);
  for (std::size_t i = 1; i < size; ++i) bytes[i - 1] = data[i];
  const auto packet = decoder.decode({bytes.get(), size - 1}, trend);
  if (packet) check(**packet);
  if (const auto* made_up = decoder.conceal()) check(*made_up);
  decoder.reset();
  return 0;
}
