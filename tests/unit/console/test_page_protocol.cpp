// SPDX-License-Identifier: Apache-2.0
// What pages may say, and who may speak at all.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "master/console/access.h"
#include "master/console/mark_trail.h"
#include "tests/unit/console/frames.h"

namespace telekerf::master {
namespace {

using testing::bytes_of;

TEST(PageFrames, AreTakenAsTheyAre) {
  PageFrame frame;
  frame.flags = PageFrame::kHeld;
  frame.sequence = 41;
  frame.page_ms = 1234.5;
  frame.x_m = -0.01F;
  const auto parsed = parse_frame(bytes_of(frame));
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->sequence, 41u);
  EXPECT_EQ(parsed->x_m, -0.01F);
}

TEST(PageFrames, ThatAreNoneAreRefused) {
  const PageFrame good;
  EXPECT_FALSE(parse_frame(bytes_of(good).first(31)));
  const auto wrong = [&](auto change) {
    PageFrame frame = good;
    change(frame);
    EXPECT_FALSE(parse_frame(bytes_of(frame)));
  };
  wrong([](PageFrame& f) { f.type = 2; });
  wrong([](PageFrame& f) { f.version = 0; });
  wrong([](PageFrame& f) { f.x_m = NAN; });
  wrong([](PageFrame& f) { f.y_m = 1e9F; });
  wrong([](PageFrame& f) { f.page_ms = -1.0; });
  wrong([](PageFrame& f) { f.page_ms = INFINITY; });
  wrong([](PageFrame& f) { f.pressure = NAN; });
}

TEST(PageCommands, HaveAWordAndWhatItNeeds) {
  const auto beta = parse_command(R"({"do":"beta","value":0.25})");
  ASSERT_TRUE(beta);
  EXPECT_EQ(beta->kind, PageCommand::Kind::kBeta);
  EXPECT_EQ(beta->value, 0.25);
  EXPECT_EQ(parse_command(R"({"do":"take","text":"abc"})")->text, "abc");
  EXPECT_EQ(parse_command(R"({"do":"stop"})")->kind, PageCommand::Kind::kStop);
  const std::string_view none[] = {"",
                                   "{",
                                   "[]",
                                   "null",
                                   "7",
                                   R"({"do":7})",
                                   R"({"do":"fly"})",
                                   R"({"do":"beta"})",
                                   R"({"do":"beta","value":"x"})",
                                   R"({"do":"netem"})",
                                   R"({"do":"arm","value":null})"};
  for (const std::string_view wrong : none) EXPECT_FALSE(parse_command(wrong)) << wrong;
  EXPECT_FALSE(parse_command(R"({"do":"netem","text":")" + std::string(300, 'x') + "\"}"));
}

TEST(PageProtocol, AnyBytesAreBorne) {
  std::mt19937 random(1);
  for (int n = 0; n < 20'000; ++n) {
    std::vector<std::byte> bytes(random() % 48);
    for (auto& byte : bytes) byte = static_cast<std::byte>(random());
    if (!bytes.empty() && n % 2 == 0) bytes[0] = std::byte{1};
    (void)parse_frame(bytes);
    (void)parse_command({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
}

TEST(Access, HostsAreAddressesAndNoNamesOfOthers) {
  for (const char* good :
       {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "192.168.1.7:8080", "bench:8080"})
    EXPECT_TRUE(host_allowed(good, "bench", 8080)) << good;
  for (const char* bad : {"", "evil.example:8080", "127.0.0.1", "127.0.0.1:80", "localhost.evil.example:8080",
                          "bench.evil:8080", ":8080", "127.0.0.1:8080x"})
    EXPECT_FALSE(host_allowed(bad, "bench", 8080)) << bad;
  EXPECT_FALSE(host_allowed(":8080", "", 8080));
  EXPECT_TRUE(host_allowed("127.0.0.1", "", 80));
}

TEST(Access, OriginsAreThisPageAlone) {
  EXPECT_TRUE(origin_allowed("", "http", "127.0.0.1:8080"));
  EXPECT_TRUE(origin_allowed("http://127.0.0.1:8080", "http", "127.0.0.1:8080"));
  for (const char* bad : {"http://127.0.0.1:8081", "https://127.0.0.1:8080", "null", "http://evil.example"})
    EXPECT_FALSE(origin_allowed(bad, "http", "127.0.0.1:8080")) << bad;
  EXPECT_TRUE(origin_allowed("https://bench:8443", "https", "bench:8443"));
  EXPECT_FALSE(origin_allowed("http://bench:8443", "https", "bench:8443"));
}

TEST(Access, OnlyTheTokenOpens) {
  const std::string token = new_token();
  EXPECT_EQ(token.size(), 32u);
  EXPECT_NE(token, new_token());
  EXPECT_TRUE(token_matches(token, token));
  EXPECT_FALSE(token_matches(token, token.substr(1)));
  EXPECT_FALSE(token_matches("", ""));
}

TEST(MarkTrail, HoldsEachPlaceOnce) {
  MarkTrail mark;
  for (int lap = 0; lap < 3; ++lap) {
    for (int n = 0; n < 1000; ++n) mark.add({n * 10e-6, 0.0});
  }
  EXPECT_EQ(mark.size(), 250u);
  EXPECT_EQ(mark.from(248, 100).size(), 2u);
  EXPECT_EQ(mark.from(1000, 100).size(), 0u);
  mark.add({NAN, 0.0});
  mark.add({1e300, 0.0});
  EXPECT_EQ(mark.size(), 250u);
  const std::uint32_t generation = mark.generation();
  mark.clear();
  EXPECT_EQ(mark.size(), 0u);
  EXPECT_NE(mark.generation(), generation);
}

}  // namespace
}  // namespace telekerf::master
