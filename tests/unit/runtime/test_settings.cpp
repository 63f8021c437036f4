// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>

#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

struct Sample {
  double stream_hz = 1000;
  int block = 16;
  bool engage = false;
  std::string law = "local";
};

Sample parsed(const std::string& arguments) {
  Sample sample;
  Settings settings;
  settings.add("stream_hz", sample.stream_hz, {.min = 100, .max = 10000}, "stream rate");
  settings.add("block", sample.block, {.min = 4, .max = 64}, "samples a block");
  settings.add("engage", sample.engage, "engage at once");
  settings.add("law", sample.law, "law", {"local", "anchored"});
  CLI::App app;
  settings.attach(app);
  app.parse(arguments, false);
  settings.fill();
  return sample;
}

std::string refusal_of(const std::string& arguments) {
  try {
    (void)parsed(arguments);
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "no refusal";
}

TEST(Settings, CommandLineOverridesFileOverridesDefault) {
  const std::string file = testing::TempDir() + "settings.toml";
  std::ofstream(file) << "stream_hz = 500\nblock = 8\nlaw = 'anchored'\n";
  const Sample sample = parsed("--config " + file + " --block 32 --engage");
  EXPECT_EQ(sample.stream_hz, 500);
  EXPECT_EQ(sample.block, 32);
  EXPECT_TRUE(sample.engage);
  EXPECT_EQ(sample.law, "anchored");
}

TEST(Settings, RefusalsNameKeyValueAndBound) {
  EXPECT_EQ(refusal_of("--block 65"), "command line: block = 65: must lie within [4, 64]");
  EXPECT_EQ(refusal_of("--law sideways"), "command line: law = 'sideways': must be one of local, anchored");
  EXPECT_NE(refusal_of("--stream-hz abc").find("stream-hz"), std::string::npos);
  EXPECT_NE(refusal_of("--block 4.5").find("whole number"), std::string::npos);
}

}  // namespace
}  // namespace telekerf
