// SPDX-License-Identifier: Apache-2.0
// The fuzzers' bounded, repeatable variant: seeds mutated with a fixed generator.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/vector_drawings.h"

namespace telekerf::vision {
namespace {

const std::vector<std::string> kSvgSeeds{
    R"svg(<svg stroke="red" width="40mm" height="30mm" viewBox="0 0 400 300"><g transform="translate(10,20) rotate(30)"><circle cx="100" cy="50" r="50"/><path d="M10 10 h50 v50 h-50z m100 100 a25 25 0 1 1 50 0 a 25,25 0 11-50 0"/><rect x="2" y="1" width="5" height="2" rx="5"/></g></svg>)svg",
    R"svg(<svg stroke="red"><path d="M 0 0 C 10 10 20 10 30 0 S 50 -10 60 0 Q 70 10 80 0 T 100 0 L 1e3 2e-3 H 4 V-5 Z"/><polygon points="0,0 1,1 2,0"/></svg>)svg",
    R"svg(<svg stroke="red" viewBox="0 0 1 1" width="1in"><line x1="1cm" x2="2mm"/><ellipse rx="3" ry="2" transform="skewX(30) matrix(1 2 3 4 5 6)"/></svg>)svg",
    R"svg(<svg stroke="red" width="9cm"><defs><symbol id="s" viewBox="0 0 4 4"><path id="p" d="M0 0L4 4"/></symbol><g id="g"><use href="#s" width="50%" height="2"/><use xlink:href="#p" x="3" y="1"/></g></defs><use href="#g"/><svg x="2" y="1" width="3" height="4" viewBox="1 1 2 2" overflow="visible" preserveAspectRatio="xMaxYMin slice"><use href="#g" transform="rotate(5)"/></svg><text>t</text></svg>)svg"};
const std::vector<std::string> kDxfSeeds{
    "0\nSECTION\n2\nHEADER\n9\n$"
    "INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n10\n5\n20\n5\n40\n10\n0\nARC\n10\n1\n20"
    "\n2\n40\n3\n50\n10\n51\n200\n0\nENDSEC\n0\nEOF\n",
    "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n90\n2\n70\n1\n10\n20\n20\n0\n42\n1\n10\n24\n20\n0\n42\n-0."
    "5\n0\nELLIPSE\n10\n0\n20\n0\n11\n3\n21\n1\n40\n0.5\n41\n0\n42\n6.28\n0\nENDSEC\n0\nEOF\n",
    "0\nSECTION\n2\nENTITIES\n0\nSPLINE\n70\n4\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n41\n1\n41\n0"
    ".7\n41\n1\n10\n10\n20\n0\n10\n10\n20\n10\n10\n0\n20\n10\n0\nPOLYLINE\n70\n1\n0\nVERTEX\n10\n0\n20\n0\n0"
    "\nVERTEX\n10\n2\n20\n0\n42\n0.4\n0\nSEQEND\n0\nENDSEC\n0\nEOF\n",
    "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n10\n1\n20\n2\n0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n0\nENDBLK\n0\n"
    "BLOCK\n2\nB"
    "\n10\n0\n20\n0\n0\nINSERT\n2\nA\n10\n3\n20\n4\n50\n30\n70\n2\n71\n2\n44\n1\n45\n1\n0\nENDBLK\n0\nENDSEC"
    "\n0\nSECTION"
    "\n2\nENTITIES\n0\nINSERT\n2\nB\n41\n2\n42\n0.5\n230\n-1\n0\nINSERT\n2\nA\n0\nTEXT\n0\nENDSEC\n0\nEOF\n"};
const std::vector<std::string> kTokens{
    "nan",  "inf",       "-1e308", "1e308", "1e-308", "0",      "-0",         "99999999999999999999",
    "M",    "Z",         "a",      "<g>",   "</g>",   "\"",     ">",          "(",
    ")",    ",",         "\n0\n",  "10\n",  "40\n",   "SPLINE", "CIRCLE",     std::string(1, '\0'),
    "<!--", "<![CDATA[", "&#0;",   "<use",  "id='g'", "INSERT", "0\nENDBLK\n"};

std::string mutated(const std::vector<std::string>& seeds, std::mt19937_64& rng) {
  const auto pick = [&](std::size_t n) {
    return static_cast<std::size_t>(rng() % std::max<std::size_t>(1, n));
  };
  std::string text = seeds[pick(seeds.size())];
  for (std::size_t i = 1 + pick(8); i-- > 0;) {
    const std::size_t at = pick(text.size());
    switch (pick(6)) {
      case 0:
        text[at] = static_cast<char>(rng());
        break;
      case 1:
        text.erase(at, 1 + pick(12));
        break;
      case 2:
        text = text.substr(0, at) + kTokens[pick(kTokens.size())] + text.substr(at);
        break;
      case 3:
        text = text.substr(0, at) + text.substr(pick(text.size()), pick(80)) + text.substr(at);
        break;
      case 4:
        text.resize(at + 1);
        break;
      default:
        text[at] = static_cast<char>('0' + pick(10));
        break;
    }
    if (text.empty()) text.push_back(' ');
  }
  return text;
}

TEST(VectorFuzz, AnyBytesGiveADrawingOrASentence) {
  for (const bool svg : {true, false}) {
    std::mt19937_64 rng(svg ? 1 : 2);
    for (int i = 0; i < 6000; ++i) {
      const std::string text = mutated(svg ? kSvgSeeds : kDxfSeeds, rng);
      ASSERT_EQ(trouble_of(text, svg), "") << "input " << i << ":\n" << text;
    }
    for (const std::string& seed : svg ? kSvgSeeds : kDxfSeeds) {
      EXPECT_TRUE(svg ? read_svg(seed).has_value() : read_dxf(seed).has_value()) << seed;
      for (std::size_t n = 0; n <= seed.size(); n += 3)
        ASSERT_EQ(trouble_of(seed.substr(0, n), svg), "") << seed.substr(0, n);
    }
  }
}

TEST(VectorFuzz, AHubOfLinesIsJoinedInReasonableTime) {
  constexpr std::size_t kLines = 8000;
  std::string text = "<svg stroke='black'><path d=\"";
  for (std::size_t i = 0; i < kLines; ++i) {
    const double angle = 2.0 * M_PI * static_cast<double>(i) / static_cast<double>(kLines);
    text += fmt::format("M0 0L{:.6f} {:.6f}", 99.0 * std::cos(angle), 99.0 * std::sin(angle));
  }
  const auto cpu_s = [](auto&& work) {
    const std::clock_t before = std::clock();
    work();
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  decltype(read_svg(text)) out = read_svg("");
  const double reading_s = cpu_s([&] { out = read_svg(text + "\"/></svg>"); });
  ASSERT_TRUE(out) << out.error();
  ASSERT_EQ(out->contours.size(), kLines / 2) << "two and two through the hub";
  for (const auto& line : out->contours) {
    ASSERT_EQ(line.size(), 3u);
    EXPECT_EQ(line.points_m[1], Vec2(0, 0));
  }
  // What this machine needs to look at each line beside each other once, in the plainest way.
  std::vector<Vec2> tips;
  for (const auto& line : out->contours)
    tips.insert(tips.end(), {line.points_m.front(), line.points_m.back()});
  std::size_t turns = 0;
  const double peer_s = cpu_s([&] {
    for (const Vec2& a : tips)
      for (const Vec2& b : tips) turns += std::atan2(geometry::cross(a, b), a.dot(b)) > 0.0 ? 1 : 0;
  });
  ASSERT_GT(turns, kLines);
  EXPECT_LT(reading_s, 3.0 * peer_s) << "about as much; reading " << reading_s << " s, the peer " << peer_s
                                     << " s";
}

}  // namespace
}  // namespace telekerf::vision
