// SPDX-License-Identifier: Apache-2.0
// The queue before a bottleneck while its rate changes: between stages, at a switch, and as recorded.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "common/runtime/startup_error.h"
#include "netem/core/emulator.h"
#include "netem/core/trace.h"
#include "netem/verify/verify.h"

namespace telekerf::netem {
namespace {

constexpr std::int64_t kMs = 1'000'000;

DirectionProfile of(const std::string& text) { return parse_profile("[both]\n" + text, "test").forward; }

std::vector<std::int64_t> arrivals_ms(Emulator& emulator) {
  std::vector<std::int64_t> out;
  while (const auto deadline = emulator.next_deadline()) out.push_back(emulator.pop(*deadline)->due_ns / kMs);
  return out;
}

// 1 byte a millisecond, then 1000.
const std::string kRising =
    "delay_ms = 20\nrate_kbit_per_s = 8\nqueue_bytes = 20000\n"
    "[[stage]]\nfrom_s = 1\n[stage.both]\nrate_kbit_per_s = 8000\n";

TEST(Bottleneck, ARisingRateServesWhatWaitsAtOnce) {
  Emulator emulator(of(kRising), {1});
  for (int i = 0; i < 10; ++i) (void)emulator.push(0, 500U, 0);
  EXPECT_EQ(emulator.push(1000 * kMs, 1000U, 0).queued_ns, 5 * kMs) << "4 ms of what waits and its own";
  EXPECT_EQ(arrivals_ms(emulator),
            (std::vector<std::int64_t>{520, 1020, 1020, 1021, 1021, 1022, 1022, 1023, 1023, 1024, 1025}));
}

TEST(Bottleneck, AFallingRateHoldsUpWhatWaits) {
  Emulator emulator(of("rate_kbit_per_s = 8\nqueue_bytes = 20000\n[[stage]]\nfrom_s = 1\n[stage.both]\n"
                       "rate_kbit_per_s = 1\n[[stage]]\nfrom_s = 5\n[stage.both]\nrate_kbit_per_s = 0\n"),
                    {1});
  for (int i = 0; i < 6; ++i) (void)emulator.push(0, 400U, 0);
  // 1000 bytes in the first second, 500 in the next four, and then nothing holds anything up.
  EXPECT_EQ(arrivals_ms(emulator), (std::vector<std::int64_t>{400, 800, 2600, 5000, 5000, 5000}));
  EXPECT_EQ(emulator.push(6000 * kMs, 400U, 0).queued_ns, 0);
}

TEST(Bottleneck, TheQueueIsCountedInBytesWhateverTheRateWillBe) {
  Emulator emulator(of("rate_kbit_per_s = 8\nqueue_bytes = 1000\n[[stage]]\nfrom_s = 1\n[stage.both]\n"
                       "rate_kbit_per_s = 8000\nqueue_bytes = 3000\n"),
                    {1});
  EXPECT_FALSE(emulator.push(600 * kMs, 500U, 0).queue_full);
  EXPECT_FALSE(emulator.push(600 * kMs, 500U, 0).queue_full);
  EXPECT_TRUE(emulator.push(600 * kMs, 1U, 0).queue_full);
  EXPECT_FALSE(emulator.push(601 * kMs, 1U, 0).queue_full);
  EXPECT_TRUE(emulator.push(601 * kMs, 1U, 0).queue_full);
  EXPECT_FALSE(emulator.push(1000 * kMs, 2399U, 0).queue_full) << "601 still wait";
  EXPECT_TRUE(emulator.push(1000 * kMs, 1U, 0).queue_full);
  EXPECT_EQ(emulator.counters().queue_full, 3U);
}

TEST(Bottleneck, ASwitchReTimesWhatWaitsAndNothingElse) {
  Emulator emulator(of("delay_ms = 20\nrate_kbit_per_s = 8\nqueue_bytes = 20000"), {1});
  for (int i = 0; i < 4; ++i) (void)emulator.push(0, 500U, static_cast<std::uint64_t>(i));
  CompiledProfile fast(of("delay_ms = 5\nrate_kbit_per_s = 8000\nqueue_bytes = 20000"));
  // At 510 ms the first has passed (due at 520), of the second 490 bytes are left.
  emulator.switch_to(fast, 510 * kMs);
  const PacketOutcome next = emulator.push(510 * kMs, 510U, 4);
  EXPECT_EQ(next.queued_ns, 2 * kMs);
  std::vector<std::int64_t> due_us;
  while (const auto deadline = emulator.next_deadline()) {
    const auto delivery = emulator.pop(*deadline);
    EXPECT_EQ(delivery->tag, due_us.size()) << "in their order";
    due_us.push_back(delivery->due_ns / 1000);
  }
  EXPECT_EQ(due_us, (std::vector<std::int64_t>{520'000, 530'490, 530'990, 531'490, 531'490}));
  EXPECT_EQ(next.due_ns, 531'490'000) << "behind the last of the old network";
}

TEST(Bottleneck, ASwitchToASlowerOneHoldsUpWhatWaits) {
  Emulator emulator(of("rate_kbit_per_s = 8000\nqueue_bytes = 20000"), {1});
  for (int i = 0; i < 3; ++i) (void)emulator.push(0, 1000U, 0);
  CompiledProfile slow(of("rate_kbit_per_s = 8\nqueue_bytes = 20000"));
  emulator.switch_to(slow, kMs);
  CompiledProfile open(of("delay_ms = 0"));
  EXPECT_EQ(emulator.next_deadline(), kMs);
  emulator.switch_to(open, 500 * kMs);
  EXPECT_EQ(arrivals_ms(emulator), (std::vector<std::int64_t>{1, 500, 500}));
}

/// Whatever the stages: no byte leaves faster than the rates allow, and none waits while the bottleneck
/// idles.
TEST(Bottleneck, ServesExactlyWhatItsRatesAllow) {
  std::mt19937 random(4);
  for (int round = 0; round < 50; ++round) {
    std::string text = "rate_kbit_per_s = 80\nqueue_bytes = 4000\n";
    std::vector<double> bytes_per_ms{10.0};
    std::vector<std::int64_t> from_ms{0};
    for (int i = 0; i < 5; ++i) {
      from_ms.push_back(from_ms.back() + 1 + static_cast<std::int64_t>(random() % 200));
      bytes_per_ms.push_back(static_cast<double>(1 + random() % 100));
      text += "[[stage]]\nfrom_s = " + std::to_string(static_cast<double>(from_ms.back()) * 1e-3) +
              "\n[stage.both]\nrate_kbit_per_s = " + std::to_string(8.0 * bytes_per_ms.back()) + "\n";
    }
    const auto capacity = [&](double from, double to) {
      double bytes = 0.0;
      for (std::size_t i = 0; i < from_ms.size(); ++i) {
        const double end = i + 1 < from_ms.size() ? static_cast<double>(from_ms[i + 1]) : 1e9;
        bytes += bytes_per_ms[i] * std::max(0.0, std::min(to, end) - std::max(from, double(from_ms[i])));
      }
      return bytes;
    };
    Emulator emulator(of(text), {1});
    double free_ms = 0.0;
    for (std::int64_t ms = 0; ms < 1200; ms += static_cast<std::int64_t>(random() % 30)) {
      const auto size = static_cast<std::uint32_t>(1 + random() % 1000);
      const PacketOutcome outcome = emulator.push(ms * kMs, size, 0);
      if (outcome.queue_full) continue;
      const double begins = std::max(free_ms, static_cast<double>(ms));
      free_ms = static_cast<double>(ms) + static_cast<double>(outcome.queued_ns) * 1e-6;
      ASSERT_NEAR(capacity(begins, free_ms), size, 1e-3) << text << ms;
    }
  }
}

TEST(Bottleneck, VerifySeesAQueueThatKeepsTheOldRate) {
  const DirectionProfile rising = of(kRising);
  Traffic traffic;
  traffic.packets = 2'000;
  const auto complaint = [&](const DirectionProfile& emulated) {
    std::string names;
    for (const StageReport& report : verify_direction(rising, emulated, Direction::kForward, traffic)) {
      for (const Check& check : report.checks) {
        if (!check.good()) names += check.name + "; ";
      }
    }
    return names;
  };
  EXPECT_EQ(complaint(rising), "");
  DirectionProfile late = rising;
  late.stages[1].conditions.rate_bit_per_s *= 1.01;
  EXPECT_NE(complaint(late).find("changing rate"), std::string::npos) << complaint(late);
}

struct Files {
  Files(const std::string& down, const std::string& up) : stem(testing::TempDir() + "/telekerf-rate") {
    stem += std::to_string(::getpid());
    std::ofstream(stem + ".down") << down;
    std::ofstream(stem + ".up") << up;
  }
  ~Files() {
    std::remove((stem + ".down").c_str());
    std::remove((stem + ".up").c_str());
  }
  std::string stem;
};

TEST(RateTrace, EachOpportunityTakesItsBytes) {
  const Files files("2\n4\n4\n9\n", "5\n");
  Profile profile = load_profile(files.stem + ".up");
  EXPECT_EQ(profile.backward.rate_trace->at_ns, (std::vector<std::int64_t>{5 * kMs}));
  EXPECT_EQ(load_profile(files.stem + ".down").forward.rate_trace->at_ns, profile.forward.rate_trace->at_ns);
  EXPECT_EQ(
      trace_note(profile),
      "forward is recorded for 0.009 s, then nothing gets through (trace_end = \"repeat\" begins it anew); "
      "backward is recorded for 0.005 s, then nothing gets through (trace_end = \"repeat\" begins it anew)");
  Emulator once(profile.forward, {1});
  EXPECT_EQ(once.push(0, 800U, 0).due_ns, 2 * kMs);
  EXPECT_EQ(once.push(0, 700U, 0).due_ns, 2 * kMs) << "1500 bytes at once";
  EXPECT_EQ(once.push(0, 1U, 0).due_ns, 4 * kMs);
  EXPECT_EQ(once.push(2 * kMs, 3000U, 0).due_ns, 9 * kMs) << "2999 in the two, one left";
  EXPECT_TRUE(once.push(3 * kMs, 1500U, 0).after_trace) << "no opportunity is left for its last byte";
  EXPECT_EQ(once.push(10 * kMs, 1U, 0).lost(), true);
  EXPECT_EQ(once.counters().after_trace, 2U);
  EXPECT_EQ(once.counters().lost, 0U);

  profile.forward.trace_end = TraceEnd::kRepeat;
  Emulator again(profile.forward, {1});
  EXPECT_EQ(again.push(9 * kMs, 1500U, 0).due_ns, 9 * kMs);
  EXPECT_EQ(again.push(9 * kMs, 1500U, 0).due_ns, 11 * kMs);
  EXPECT_EQ(again.push(9 * kMs, 4500U, 0).due_ns, 18 * kMs);
  EXPECT_EQ(again.push(40 * kMs, 1U, 0).due_ns, 40 * kMs);
  EXPECT_EQ(again.push(41 * kMs, 1U, 0).due_ns, 45 * kMs);
  EXPECT_EQ(trace_note(profile).find("forward is recorded for 0.009 s, then it begins anew; "), 0u);
}

TEST(RateTrace, StandsInAProfileBesideALaw) {
  const Files files("2\n4\n9\n", "5\n");
  const std::string keys = "[both]\nqueue_bytes = 3000\ndelay_ms = 7\n[forward]\nrate_trace = \"" +
                           files.stem + ".down\"\ntrace_end = \"repeat\"\n[backward]\nrate_kbit_per_s = 80\n";
  const Profile profile = parse_profile(keys, "test");
  Emulator emulator(profile.forward, {1});
  EXPECT_EQ(emulator.push(0, 1500U, 0).due_ns, 9 * kMs);
  EXPECT_EQ(emulator.push(0, 1500U, 0).due_ns, 11 * kMs);
  EXPECT_TRUE(emulator.push(0, 1U, 0).queue_full);
  EXPECT_EQ(profile.backward.rate_trace, nullptr);
  Traffic traffic;
  traffic.packets = 5'000;
  for (const StageReport& report : verify(profile, traffic)) EXPECT_TRUE(report.good());
  DirectionProfile other = profile.forward;
  RateTrace moved = *other.rate_trace;
  moved.at_ns[1] += kMs;
  other.rate_trace = std::make_shared<RateTrace>(moved);
  EXPECT_FALSE(verify_direction(profile.forward, other, Direction::kForward, traffic).front().good());
}

TEST(RateTrace, DamagedFilesAreRefusedByLine) {
  for (const auto& [text, named] : {std::pair<std::string, std::string>{"", "no opportunity"},
                                    {"0\n0\n", "no opportunity"},
                                    {"1\nx\n", "line 2 ('x')"},
                                    {"1\n2 3\n", "line 2"},
                                    {"1\n\n", "line 2"},
                                    {"3\n2\n", "line 2 ('2'): must not go backwards"},
                                    {"-1\n", "line 1"},
                                    {"18446744073709551616\n", "line 1"}}) {
    const Files files(text, "1\n");
    try {
      (void)load_profile(files.stem + ".down");
      FAIL() << "accepted: " << text;
    } catch (const StartupError& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(named), std::string::npos) << refusal.what();
    }
  }
  const Files files("1\n", "1\n");
  std::remove((files.stem + ".up").c_str());
  EXPECT_THROW((void)load_profile(files.stem + ".down"), StartupError) << "a pair";
}

}  // namespace
}  // namespace telekerf::netem
