// SPDX-License-Identifier: Apache-2.0
// The report's plots: packed, and unpacked as the page does; what another run left; remarks.
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/runtime/startup_error.h"
#include "experiments/report/judgement.h"
#include "experiments/report/page_figures.h"
#include "experiments/report/plot_data.h"
#include "experiments/report/stored_claims.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::vector<unsigned char> from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> out;
  unsigned sum = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    sum = (sum << 6) | static_cast<unsigned>(letters.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out.push_back(static_cast<unsigned char>(sum >> bits));
  }
  return out;
}

/// As the script in page.html does it.
std::vector<TimedLine> unpacked(const ordered_json& plot) {
  std::size_t points = 0;
  for (const auto& line : plot["lines"]) points += line["n"].get<std::size_t>();
  std::vector<unsigned char> bytes(4 * points);
  uLongf size = bytes.size();
  const auto packed = from_base64(plot["data"].get<std::string>());
  EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(size, bytes.size());
  std::size_t at = 0;
  std::vector<TimedLine> out;
  for (const auto& line : plot["lines"]) {
    const auto n = line["n"].get<std::size_t>();
    const auto numbers = [&](const ordered_json& range) {
      std::vector<double> values;
      unsigned sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        sum = (sum + bytes[at + i] + (bytes[at + n + i] << 8)) & 0xffff;
        values.push_back(range[0].get<double>() +
                         (range[1].get<double>() - range[0].get<double>()) * sum / 0xffff);
      }
      at += 2 * n;
      return values;
    };
    TimedLine one{line["label"], {}, {}};
    one.x = numbers(line["x_range"]);
    one.y = numbers(line["y_range"]);
    out.push_back(one);
  }
  return out;
}

TEST(ReportPlots, WhatIsUnpackedIsWhatWasPacked) {
  TimedPanel panel{"p", "time [s]", "[um]", {{"wave", {}, {}}, {"one value", {}, {}}, {"none", {}, {}}}};
  for (int i = 0; i < 1150; ++i) {
    panel.lines[0].x.push_back(3.0 + 0.01 * i);
    panel.lines[0].y.push_back(-2.0 * std::sin(0.1 * i) + 0.3);
    panel.lines[1].x.push_back(3.0 + 0.01 * i);
    panel.lines[1].y.push_back(7.25);
  }
  const auto lines = unpacked(plot_data(panel));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].label, "wave");
  EXPECT_TRUE(lines[2].x.empty());
  for (std::size_t line = 0; line < 2; ++line) {
    ASSERT_EQ(lines[line].x.size(), 1150u) << "every point of it";
    for (std::size_t i = 0; i < 1150; ++i) {
      EXPECT_NEAR(lines[line].x[i], panel.lines[line].x[i], 15.0 / 130000.0);
      EXPECT_NEAR(lines[line].y[i], panel.lines[line].y[i], 4.0 / 130000.0);
    }
  }
}

TEST(ReportPlots, PanelsOverTimeAreThereToZoomAndNoPeakIsLost) {
  const fs::path png = fs::path(testing::TempDir()) / ("zoom-" + std::to_string(getpid()) + ".png");
  const fs::path csv_file = fs::path(png).replace_extension(".csv");
  std::ofstream csv(csv_file);
  csv << "panel,x_axis,y_axis,line,x,y\n";
  for (int i = 0; i < 5000; ++i)
    csv << "\"a <b>, \"\"c\"\"\",\"time [s]\",\"[um]\",\"tool\"," << i * 1e-3 << ","
        << (i == 1234 ? 99.0 : 1.0) << "\n";
  csv << "\"plane\",\"x [mm]\",\"y [mm]\",\"path\",1,2\n";
  csv.close();
  const std::string html = zoomable_panels(png);
  EXPECT_NE(html.find("zoom: a &lt;b&gt;, &quot;c&quot;"), html.npos) << html.substr(0, 200);
  EXPECT_EQ(html.find("plane"), html.npos) << "a path in the plane is no function of time";
  EXPECT_LT(html.size(), 20000u);
  const auto panels = timed_panels(csv_file);
  ASSERT_EQ(panels.size(), 1u);
  const auto lines = unpacked(plot_data(panels[0]));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_GT(lines[0].x.size(), 590u) << "more than a picture of it shows";
  const auto top = std::max_element(lines[0].y.begin(), lines[0].y.end());
  EXPECT_NEAR(*top, 99.0, 1e-3);
  EXPECT_NEAR(lines[0].x[static_cast<std::size_t>(top - lines[0].y.begin())], 1.234, 1e-3);
  EXPECT_EQ(zoomable_panels("/nowhere/at/all.png"), "");
}

Claim claim_named(const std::string& id, bool negative = false) {
  Claim claim;
  claim.id = id;
  claim.bound = 1.0;
  claim.negative = negative;
  return claim;
}

/// What is said of a claims.json of this text; empty: it is read.
std::string complaint_of(const std::string& text) {
  const fs::path folder = fs::path(testing::TempDir()) / ("stored-" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "claims.json") << text;
  try {
    (void)stored_claims(folder);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

std::string stored(const std::string& claim) {
  return R"({"version": "1", "commit": "c", "seed": 1, "quick": false, "claims": [)" + claim + "]}";
}

TEST(StoredClaims, WhatARunWritesIsRead) {
  const ordered_json rows = claims_json(
      {{claim_named("a"), 0.5, Verdict::kHeld, ""}, {claim_named("b"), {}, Verdict::kNotAssessed, "w"}});
  EXPECT_EQ(complaint_of(ordered_json{{"seed", 1}, {"quick", true}, {"claims", rows}}.dump()), "");
}

TEST(StoredClaims, WhatNoRunWritesIsRefusedByItsName) {
  const std::string good = R"({"id": "a", "value": 1.5, "verdict": "held"})";
  EXPECT_EQ(complaint_of(stored(good)), "");
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {stored(R"({"id": "a", "value": "much", "verdict": "held"})"),
            "claim a: value = \"much\": must be a number or null"},
           {stored(R"({"id": "a", "verdict": "held"})"),
            "claim a: value = missing: must be a number or null"},
           {stored(R"({"id": "a", "value": 1, "verdict": "good"})"), "claim a: verdict = \"good\": must be"},
           {stored(R"({"id": "a", "value": null, "verdict": "held"})"),
            "claim a: verdict = \"held\": must be \"not assessed\""},
           {stored(R"({"id": "a", "value": 1, "verdict": "not assessed"})"), "does not go with a figure"},
           {stored(R"({"id": 3, "value": 1, "verdict": "held"})"), "claims.0.id = 3: must be a word"},
           {stored(good + "," + good), "claim a: stands there twice"},
           {stored("7"), "claims.0 is no object"},
           {stored(R"({"id": "a", "value": 1e999, "verdict": "held"})"), "is no JSON object"},
           {R"({"seed": -1, "quick": false, "claims": []})", "seed = -1: must be a whole number"},
           {R"({"seed": "one", "quick": false, "claims": []})", "seed = \"one\""},
           {R"({"seed": 1, "quick": "no", "claims": []})", "quick = \"no\": must be true or false"},
           {R"({"seed": 1, "quick": false, "claims": {}})", "claims = {}: must be a list"},
           {"[]", "is no JSON object"}}) {
    const std::string said = complaint_of(text);
    EXPECT_NE(said.find(named), said.npos) << text << "\n" << said;
    EXPECT_NE(said.find("name the --out of another run"), said.npos) << said;
  }
}

TEST(ReportRemark, WhatIsKnownToMissAndWhatNoLongerDoes) {
  const Claim known = claim_named("a", true), plain = claim_named("b");
  EXPECT_EQ(remark_of({known, 2.0, Verdict::kNotHeld, ""}), "known");
  EXPECT_NE(remark_of({known, 2.0, Verdict::kHeld, ""}).find("take its negative = true away"),
            std::string::npos);
  EXPECT_EQ(remark_of({known, {}, Verdict::kNotAssessed, ""}), "");
  EXPECT_EQ(remark_of({plain, 2.0, Verdict::kHeld, ""}), "");
  EXPECT_EQ(remark_of({plain, 2.0, Verdict::kNotHeld, ""}), "");
  EXPECT_TRUE(claims_json({{known, 2.0, Verdict::kHeld, ""}})[0].contains("remark"));
}

}  // namespace
}  // namespace telekerf::experiments
