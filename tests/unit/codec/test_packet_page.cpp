// SPDX-License-Identifier: Apache-2.0
// docs/reference/packet.md says what is in a packet: the decoder that was written from the page alone reads
// what the encoder writes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include "common/codec/encoder.h"

namespace telekerf::codec {
namespace {

using Signal = std::function<Vec3(double t_s)>;

Vec3 smooth(double t) {
  return {0.02 * std::sin(1.9 * t), 0.015 * std::sin(1.4 * t + 1.0), 5e-5 * std::sin(56 * t)};
}
Vec3 quick(double t) { return {0.3 * std::sin(9 * t), 0.2 * std::cos(7 * t), 0.01 * std::sin(400 * t)}; }
Vec3 jumping(double t) {
  return {1e-3 * std::floor(40 * t), 0.5e-3 * std::floor(40 * t), t > 0.05 ? 2e-3 : 0.0};
}

/// The packets of a stream, a line each, as decode_packet.py wants them.
std::string lines_of(const StreamSettings& settings, const Signal& signal) {
  constexpr std::array<std::uint64_t, 6> kButtons{0, 0, ~0ULL, 0xFF00, 0x5, 0};
  BlockEncoder encoder(settings);
  std::string lines;
  for (std::size_t packet = 0; packet < kButtons.size(); ++packet) {
    std::vector<Vec3> samples;
    for (int n = 0; n < settings.block; ++n)
      samples.push_back(signal(1e-3 * (static_cast<double>(packet) * settings.block + n)));
    Trend anchor;
    if (settings.anchored) anchor = {samples[0], samples[1] - samples[0]};
    std::array<std::uint8_t, 2048> out{};
    const auto size = encoder.encode(samples, kButtons[packet], anchor, out);
    EXPECT_TRUE(size);
    for (int axis = 0; axis < 3; ++axis)
      lines += fmt::format("{} {} ", anchor.value[axis], anchor.slope_per_sample[axis]);
    for (std::size_t i = 0; i < size.value_or(0); ++i) lines += fmt::format("{:02x}", out[i]);
    for (const Vec3& sample : encoder.decoded())
      lines += fmt::format(" {} {} {}", sample.x(), sample.y(), sample.z());
    lines += '\n';
  }
  return lines;
}

TEST(PacketPage, ItsDecoderReadsWhatTheEncoderWrites) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("telekerf-packets-{}", ::getpid());
  std::ofstream out(file);
  for (const bool anchored : {true, false}) {
    for (const int block : {4, 16, 33, 64}) {
      for (const double max_rms : {0.0, 2e-6}) {
        for (const Signal& signal : {Signal(smooth), Signal(quick), Signal(jumping)}) {
          out << lines_of({.block = block,
                           .keep = 4,
                           .max_rms = max_rms,
                           .redundancy = 2,
                           .integrated = !anchored,
                           .anchored = anchored},
                          signal)
              << '\n';
        }
      }
    }
  }
  out.close();
  const std::string command = fmt::format("{} {} {}", TELEKERF_PYTHON, TELEKERF_DECODER, file.string());
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace telekerf::codec
