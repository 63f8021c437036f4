// SPDX-License-Identifier: Apache-2.0
// What does a block of motion cost, and what does a lost packet do?
//
// A hand's motion is coded in blocks of 16 samples; every packet repeats the block before. Every seventh
// packet is lost. You see how small the packets are, and that the received samples are the very ones that the
// encoder knows of, bit for bit, the lost ones included: each came with the packet after it.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "common/codec/decoder.h"
#include "common/codec/encoder.h"

using telekerf::Vec3;

Vec3 hand_m(double t_s) {
  return {0.02 * std::sin(1.9 * t_s), 0.015 * std::sin(1.4 * t_s + 1.0), 50e-6 * std::sin(56.0 * t_s)};
}

int main() {
  using namespace telekerf::codec;
  const StreamSettings settings{.block = 16, .keep = 4, .redundancy = 1};
  BlockEncoder encoder(settings);
  BlockDecoder decoder;
  std::vector<Vec3> sent, received;
  double coding_error_m = 0.0;
  double bytes = 0.0;
  int lost = 0;
  for (int packet = 0; packet < 200; ++packet) {
    const auto at = [&](int n) {
      return hand_m(1e-9 * settings.sample_period_ns * (packet * settings.block + n));
    };
    std::vector<Vec3> samples;
    for (int n = 0; n < settings.block; ++n) samples.push_back(at(n));
    const Trend anchor{at(0), at(1) - at(0)};  // travels with the block: where it begins, and how fast

    std::array<std::uint8_t, 2048> room{};
    const auto size = encoder.encode(samples, /*button=*/0, anchor, room);
    if (!size) return 1;
    bytes += static_cast<double>(*size);
    for (std::size_t n = 0; n < samples.size(); ++n) {
      sent.push_back(encoder.decoded()[n]);
      coding_error_m = std::max(coding_error_m, (sent.back() - samples[n]).norm());
    }
    if (packet % 7 == 2) {
      ++lost;
      continue;
    }
    const auto decoded = decoder.decode(std::span(room).first(*size), anchor);
    if (!decoded) return 1;
    for (int age = (*decoded)->blocks - 1; age >= 0; --age) {
      const auto block = (*decoded)->blocks_newest_first[static_cast<std::size_t>(age)].samples;
      const bool is_new = received.size() + static_cast<std::size_t>(age) * block.size() < sent.size();
      if (is_new) received.insert(received.end(), block.begin(), block.end());
    }
  }
  const bool same = received == sent;
  fmt::print("200 packets, {} lost; {:.1f} bytes each, {:.2f} bits a sample of one axis\n", lost,
             bytes / 200.0, 8.0 * bytes / (3.0 * static_cast<double>(sent.size())));
  fmt::print("coding error {:.2f} um at most\n", 1e6 * coding_error_m);
  fmt::print("received as sent, bit for bit: {}\n", same ? "yes" : "no");
  return same && coding_error_m < 1e-6 ? 0 : 1;
}
