// SPDX-License-Identifier: Apache-2.0
// Nothing that a control step calls takes memory.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "tests/unit/allocations.h"

namespace telekerf::codec {
namespace {

TEST(RealTime, EncodeDecodeConcealAndAChangeTakeNoMemory) {
  for (const auto& name : codec_names()) {
    for (const double max_rms : {0.0, 1e-6}) {
      BlockEncoder encoder(
          with_codec({.block = 32, .max_rms = max_rms, .redundancy = 2, .threshold = 1e-5}, name));
      BlockDecoder decoder;
      std::vector<Vec3> samples(static_cast<std::size_t>(encoder.settings().block));
      std::vector<std::uint8_t> packet(4096);
      const auto before = telekerf::testing::allocations();
      for (int b = 0; b < 50; ++b) {
        for (std::size_t n = 0; n < samples.size(); ++n) {
          samples[n] =
              Vec3(1, 2, 3) * std::sin(0.01 * static_cast<double>(n) + b) * (b % 7 == 0 ? 1.0 : 1e-3);
        }
        const auto size = encoder.encode(samples, 0b1010, {}, packet);
        ASSERT_TRUE(size);
        ASSERT_TRUE(decoder.decode(std::span(packet).first(*size), {}));
        packet[3] ^= 0x55;
        (void)decoder.decode(std::span(packet).first(*size), {});
        (void)decoder.conceal();
        if (b % 10 == 9) encoder.change(encoder.settings());
      }
      EXPECT_EQ(telekerf::testing::allocations(), before) << name;
    }
  }
}

}  // namespace
}  // namespace telekerf::codec
