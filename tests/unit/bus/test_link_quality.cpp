// SPDX-License-Identifier: Apache-2.0
#include "common/bus/link_quality.h"

#include <gtest/gtest.h>

#include <cmath>

namespace telekerf {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// 10 s: `lost` of each thousand never come, the receiver's clock is fast by `skew`, each `late`-th comes
/// `late_ms` later.
LinkWay way(int lost, double skew, int late, std::int64_t late_ms) {
  LinkMeter meter(10.0);
  for (std::uint32_t n = 0; n < 5000; ++n) {
    const std::size_t rate = n < 1000 ? 0 : 1;
    const std::int64_t sent_ns = static_cast<std::int64_t>(n) * 2 * kMs;
    if (static_cast<int>(n % 1000) >= 1000 - lost && n != 999 && n != 4999) continue;
    const auto received_ns = static_cast<std::int64_t>(static_cast<double>(sent_ns) * (1.0 + skew)) +
                             77 * kMs + (n % static_cast<unsigned>(late) == 5 ? late_ms * kMs : 0);
    meter.add(rate, n, sent_ns, received_ns);
  }
  return meter.result();
}

TEST(LinkQuality, WhatTheMeterFinds) {
  const LinkWay found = way(21, 80e-6, 100, 30);
  EXPECT_EQ(found.rates[0].packets, 980.0);
  EXPECT_NEAR(found.rates[0].loss, 0.02, 1e-12);
  EXPECT_NEAR(found.rates[0].jitter_p999_ms, 30.0, 1.0);
  EXPECT_NEAR(found.skew_ppm, 80.0, 1.0);
  EXPECT_NEAR(found.rates[1].longest_gap_ms, 44.0, 0.1) << "21 in a row are missing";
}

TEST(LinkQuality, EachFigureHasItsWord) {
  LinkReport report;
  report.forward = report.backward = way(0, 0.0, 100, 1);
  report.rtt_p50_ms = report.rtt_p99_ms = 20.0;
  EXPECT_EQ(worst(judged(report)), LinkWord::kGood);
  EXPECT_NEAR(expected_age_ms(report), 54.0, 0.1);

  const auto word_with = [&](auto change) {
    LinkReport other = report;
    change(other);
    return worst(judged(other));
  };
  EXPECT_EQ(word_with([](LinkReport& r) { r.forward.rates[0].loss = 0.01; }), LinkWord::kFair);
  EXPECT_EQ(word_with([](LinkReport& r) { r.backward.rates[1].loss = 0.05; }), LinkWord::kBad);
  EXPECT_EQ(word_with([](LinkReport& r) { r.forward.rates[1].jitter_p999_ms = 6.0; }), LinkWord::kFair);
  EXPECT_EQ(word_with([](LinkReport& r) { r.forward.rates[1].jitter_p999_ms = 21.0; }), LinkWord::kBad);
  EXPECT_EQ(word_with([](LinkReport& r) { r.forward.rates[0].longest_gap_ms = 200.0; }), LinkWord::kBad);
  EXPECT_EQ(word_with([](LinkReport& r) { r.rtt_p99_ms = 150.0; }), LinkWord::kFair);
  EXPECT_EQ(word_with([](LinkReport& r) { r.backward.skew_ppm = -60.0; }), LinkWord::kFair);
  EXPECT_EQ(word_with([](LinkReport& r) { r.forward.rates[0].packets = 0.0; }), LinkWord::kBad);
  EXPECT_EQ(word_with([](LinkReport& r) { r.rtt_p99_ms = std::nan(""); }), LinkWord::kBad);
  EXPECT_EQ(word_with([](LinkReport& r) { r.beam_age_s = 0.05; }), LinkWord::kBad) << "older than the gate";
  for (const LinkVerdict& verdict : judged(report)) EXPECT_FALSE(verdict.remedy.empty()) << verdict.what;
}

TEST(LinkQuality, TheOtherSideIsToldTheSame) {
  const LinkWay sent = way(10, 1e-5, 50, 4);
  LinkWay back;
  read_numbers(numbers_of(sent), back);
  EXPECT_EQ(back.skew_ppm, sent.skew_ppm);
  for (std::size_t n = 0; n < LinkWay::kRates; ++n) {
    EXPECT_EQ(back.rates[n].packets, sent.rates[n].packets);
    EXPECT_EQ(back.rates[n].loss, sent.rates[n].loss);
    EXPECT_EQ(back.rates[n].jitter_p999_ms, sent.rates[n].jitter_p999_ms);
    EXPECT_EQ(back.rates[n].longest_gap_ms, sent.rates[n].longest_gap_ms);
  }
}

}  // namespace
}  // namespace telekerf
