// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

enum class Colour { kRed, kGreen };
constexpr EnumRow<Colour> kColourRows[] = {{"red", Colour::kRed, "like a heart"}, {"green", Colour::kGreen}};
constexpr EnumTable<Colour> kColours(kColourRows);

struct Sample {
  double stream_hz = 1000;
  int block = 16;
  std::uint64_t seed = 1;
  bool engage = false;
  std::string robot = "slave-keops";
  Colour colour = Colour::kRed;
  std::optional<double> loss;
  std::optional<Colour> other;
  std::vector<double> start;
  std::vector<std::string> columns;
  std::string input;
  std::string drive = "simulated";
};

void declare(Sample& sample, Settings& settings) {
  settings.add("stream_hz", sample.stream_hz, {.min = 100, .max = 10000, .unit = "Hz"}, "stream rate");
  settings.add("block", sample.block, {.min = 4, .max = 64}, "samples a block");
  settings.add("seed", sample.seed, kSeeds, "of everything random");
  settings.add("engage", sample.engage, "engage at once");
  settings.add("robot", sample.robot, kRobot, "which robot");
  settings.add("colour", sample.colour, kColours, "of the beam");
  settings.add("loss", sample.loss, {.min = 0, .max = 1}, "as a fraction");
  settings.add("other", sample.other, kColours, "another one");
  settings.add("start", sample.start, 2, {.min = -10, .max = 10}, "X,Y");
  settings.add("columns", sample.columns, kName, "to take");
  settings.add("drive", sample.drive,
               {.form = "simulated|udp:HOST:PORT",
                .complaint = [](const std::string& text) { return text == "broken" ? "must not be" : ""; }},
               "what moves it");
  settings.add("input", sample.input, kFile, "what is read").as_argument();
  settings.renamed("rate_hz", "stream_hz");
  settings.moved("automatic", "is a program of its own now: telekerf-machine");
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

Sample loaded(const std::vector<std::string>& words) {
  Sample sample;
  Settings settings;
  declare(sample, settings);
  settings.load(words);
  return sample;
}

Sample loaded(const std::string& line) { return loaded(words_of(line)); }

template <typename Load>
std::pair<std::string, ErrorKind> refusal(const Load& load) {
  try {
    load();
  } catch (const StartupError& error) {
    return {error.what(), error.kind()};
  }
  return {"no refusal", ErrorKind::kHardware};
}

std::string refusal_of(const std::string& line) {
  const auto [sentence, kind] = refusal([&] { (void)loaded(line); });
  EXPECT_EQ(kind, ErrorKind::kUsage) << line;
  return sentence;
}

std::pair<std::string, ErrorKind> refusal_of_file(const std::string& text) {
  return refusal([&] {
    Sample sample;
    Settings settings;
    declare(sample, settings);
    settings.load(ConfigFile(text, "f.toml"));
  });
}

TEST(Settings, CommandLineOverridesFileOverridesDefault) {
  const std::string file = testing::TempDir() + "settings.toml";
  std::ofstream(file) << "stream_hz = 500\nblock = 8\ncolour = 'green'\nstart = [1, 2.5]\n";
  const Sample sample = loaded("--block 32 --engage --config " + file + " here.csv --loss=0.5");
  EXPECT_EQ(sample.stream_hz, 500);
  EXPECT_EQ(sample.block, 32);
  EXPECT_TRUE(sample.engage);
  EXPECT_EQ(sample.colour, Colour::kGreen);
  EXPECT_EQ(sample.loss, 0.5);
  EXPECT_EQ(sample.other, std::nullopt);
  EXPECT_EQ(sample.start, (std::vector<double>{1, 2.5}));
  EXPECT_EQ(sample.input, "here.csv");
}

Sample loaded_by(const std::string& program, const std::string& text) {
  Sample sample;
  Settings settings;
  declare(sample, settings);
  settings.table(program);
  settings.load(ConfigFile(text, "cell-1.toml"));
  return sample;
}

TEST(Settings, OneFileServesACellWithATableAProgram) {
  const std::string file =
      "stream_hz = 500\nseed = 2\n[slave]\nblock = 8\nseed = 3\n[master]\nblock = 32\nno_such_key = 1\n";
  const Sample slave = loaded_by("slave", file);
  EXPECT_EQ(slave.stream_hz, 500) << "above all tables: for everybody";
  EXPECT_EQ(slave.block, 8);
  EXPECT_EQ(slave.seed, 3u) << "a program's own comes last";
  EXPECT_EQ(loaded_by("vision", file).block, 16) << "has no table: the default";
}

TEST(Settings, ACellsFileIsReadAsStrictlyAsAnother) {
  const auto refusal = [](const std::string& program, const std::string& file) -> std::string {
    try {
      (void)loaded_by(program, file);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("slave", "[slave]\nblock = 3\n").find("cell-1.toml: slave.block = 3"), std::string::npos);
  EXPECT_NE(refusal("slave", "[slave]\nblok = 8\n").find("unknown key 'slave.blok'"), std::string::npos);
  EXPECT_NE(refusal("slave", "[slaves]\nblock = 8\n").find("unknown key 'slaves.block'"), std::string::npos);
  EXPECT_NE(refusal("slave", "[slave]\nrate_hz = 8\n").find("is stream_hz now"), std::string::npos);
  EXPECT_NE(refusal("", "[slave]\nblock = 8\n").find("unknown key"), std::string::npos)
      << "a program that is no service reads no table";
}

TEST(Settings, NumbersAsPeopleWriteThem) {
  EXPECT_EQ(loaded("--start -.5 +2").start, (std::vector<double>{-0.5, 2}));
  EXPECT_EQ(loaded("--start -1,3 in.csv").input, "in.csv") << "a list that is complete ends";
  EXPECT_EQ(loaded("--seed 1e15").seed, 1'000'000'000'000'000U);
  EXPECT_EQ(loaded("--columns a,b").columns, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(loaded("--columns a b --block 5").columns, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(loaded(std::vector<std::string>{"--drive", ""}).drive, "");
  EXPECT_FALSE(loaded("--engage=false").engage);
}

TEST(Settings, AListOfAnyLengthMayBeGivenInParts) {
  std::vector<double> at;
  Settings settings;
  settings.add("at", at, 0, {.min = 0, .max = 100}, "points");
  settings.load(std::vector<std::string>{"--at", "1,2", "--at", "3", "4"});
  EXPECT_EQ(at, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(loaded("--columns a,b --block 5 --columns c").columns, (std::vector<std::string>{"a", "b", "c"}));
}

TEST(Settings, RefusalsNameKeyValueAndBound) {
  EXPECT_EQ(refusal_of("--block 65"), "command line: block = 65: must lie within [4, 64]");
  EXPECT_EQ(refusal_of("--stream-hz 99"), "command line: stream_hz = 99: must lie within [100, 10000] Hz");
  EXPECT_EQ(refusal_of("--stream-hz nan"), "command line: stream_hz = nan: must be a finite number");
  EXPECT_EQ(refusal_of("--stream-hz 1x"), "command line: stream_hz = 1x: must be a number");
  EXPECT_EQ(refusal_of("--stream-hz +-500"), "command line: stream_hz = +-500: must be a number");
  EXPECT_EQ(refusal_of("--block 4.5"), "command line: block = 4.5: must be a whole number");
  EXPECT_EQ(refusal_of("--colour blue"), "command line: colour = 'blue': must be one of red, green");
  EXPECT_EQ(refusal_of("--start 1 11"), "command line: start = 1 11: must lie within [-10, 10]");
  EXPECT_EQ(refusal_of("--start 1 --block 4"), "command line: start = 1: must be 2 numbers");
  EXPECT_EQ(refusal_of("--drive broken"), "command line: drive = 'broken': must not be");
  EXPECT_EQ(refusal_of("--block"), "command line: --block needs a value; see --help");
  EXPECT_EQ(refusal_of("--block --engage"), "command line: --block needs a value; see --help");
  EXPECT_EQ(refusal_of("--blok 4"), "command line: there is no --blok; see --help");
  EXPECT_EQ(refusal_of("a.csv b.csv"), "command line: 'b.csv' is not understood; see --help");
  EXPECT_EQ(refusal_of_file("block = 65\n"),
            std::pair(std::string("f.toml: block = 65: must lie within [4, 64]"), ErrorKind::kConfiguration));
  EXPECT_EQ(refusal_of_file("engage = 1\n").first, "f.toml: engage = 1: must be true or false");
  EXPECT_EQ(refusal_of_file("colour = 1\n").first, "f.toml: colour = 1: must be a text in quotes");
  EXPECT_EQ(refusal_of_file("stream_hz = '1'\n").first, "f.toml: stream_hz = '1': must be a number");
  EXPECT_NE(refusal_of_file("input = 'x'\n").first.find("unknown key 'input'"), std::string::npos);
}

TEST(Settings, NothingIsNoText) {
  const auto refused = [](std::vector<std::string> words) {
    return refusal([&] { (void)loaded(words); }).first;
  };
  EXPECT_EQ(refused({"--columns", ""}), "command line: columns = '': must not be empty");
  EXPECT_EQ(refused({"--columns", "a,,b"}), "command line: columns = 'a,,b': must not be empty");
  EXPECT_EQ(refused({""}), "command line: input = '': must not be empty");
  EXPECT_EQ(refused({"--loss", ""}), "command line: loss = '': must be a number");
  EXPECT_EQ(refusal_of("--seed 18446744073709551616"),
            "command line: seed = 18446744073709551616: must lie within [0, 1e+15]");
  EXPECT_EQ(refusal_of_file("columns = ['a', '']").first, "f.toml: columns = ['a', '']: must not be empty");
}

struct Coding {
  std::string codec = "sdct";
  double rms = 0.0;
  int keep = 4;
  std::optional<double> loss;
  double burst = 1.0;
};

std::string refusal_of_effect(const std::vector<std::string>& words, const std::string& prefix = "",
                              const std::string& file = "") {
  Coding coding;
  Settings settings;
  if (!prefix.empty()) settings.add("codec", coding.codec, TextForm{.form = "CODEC"}, "another's");
  settings.prefix(prefix);
  settings.add("codec", coding.codec, TextForm{.form = "CODEC"}, "which");
  settings.add("rms", coding.rms, {}, "an error");
  settings.add("keep", coding.keep, {}, "how many");
  settings.add("loss", coding.loss, {}, "share");
  settings.add("burst", coding.burst, {}, "length");
  settings.add("window", coding.burst, {}, "length");
  settings.not_with({"rms"}, "codec", {"raw"});
  settings.only_with({"keep"}, "codec", {"sdct", "truncated"});
  settings.only_with({"keep"}, "rms", {"0"});
  settings.not_with({"burst"}, "loss", {"0"});
  settings.only_with({"window"}, "curve", {"circle"});
  if (!file.empty()) settings.load(ConfigFile(file, "f.toml"));
  settings.load(words);
  return refusal([&] { settings.refuse_without_effect(); }).first;
}

TEST(Settings, WhatNothingReadsIsRefused) {
  const std::string none = "no refusal";
  EXPECT_EQ(refusal_of_effect({"--keep", "5"}), none);
  EXPECT_EQ(refusal_of_effect({"--codec", "raw"}), none);
  EXPECT_EQ(refusal_of_effect({"--codec", "raw", "--keep", "4"}), none) << "the default asks for nothing";
  EXPECT_EQ(refusal_of_effect({"--codec", "raw", "--keep", "5"}),
            "command line: keep has no effect with codec = raw; it needs sdct or truncated");
  EXPECT_EQ(refusal_of_effect({"--keep", "5", "--rms", "0.5"}),
            "command line: keep has no effect with rms = 0.5; it needs 0");
  EXPECT_EQ(refusal_of_effect({"--codec", "raw", "--rms", "0.5"}),
            "command line: rms has no effect with codec = raw; leave it out");
  EXPECT_EQ(refusal_of_effect({"--burst", "5"}), none) << "loss is not set";
  EXPECT_EQ(refusal_of_effect({"--burst", "5", "--loss", "0"}),
            "command line: burst has no effect with loss = 0; leave it out");
  EXPECT_EQ(refusal_of_effect({"--burst", "5", "--loss", "0.1"}), none);
  EXPECT_EQ(refusal_of_effect({"--window", "5"}), none) << "the command has no curve";
  EXPECT_EQ(refusal_of_effect({"--codec", "raw"}, "", "keep = 7"),
            "f.toml: keep has no effect with codec = raw; it needs sdct or truncated");
  EXPECT_EQ(refusal_of_effect({"--slave-codec", "raw", "--slave-keep", "5"}, "slave_"),
            "command line: slave_keep has no effect with codec = raw; it needs sdct or truncated");
}

TEST(Settings, OldNamesAreRefusedWithTheNewOnes) {
  EXPECT_EQ(refusal_of("--rate-hz 5"), "command line: --rate-hz is stream_hz now");
  EXPECT_EQ(refusal_of("--automatic"),
            "command line: --automatic is a program of its own now: telekerf-machine");
  EXPECT_EQ(refusal_of_file("rate_hz = 5\n").first, "f.toml: rate_hz = 5: is stream_hz now");
}

TEST(Settings, WhatMustBeGivenIsAskedFor) {
  Sample sample;
  Settings settings;
  declare(sample, settings);
  settings.load(words_of("--block 5"));
  EXPECT_EQ(refusal([&] { settings.require_given(); }).first, "command line: input is missing: what is read");
  settings.load(words_of("a.csv"));
  EXPECT_NO_THROW(settings.require_given());
}

TEST(Settings, ThePrintedFileReadsBackAsItWas) {
  Sample first;
  Settings settings;
  declare(first, settings);
  settings.load(std::vector<std::string>{"--block", "5", "--stream-hz", "333.25", "--colour", "green",
                                         "--loss", "0.125", "--drive", "my \"robot\"\\", "--start", "1,2",
                                         "--columns", "a,b"});
  Sample second;
  Settings again;
  declare(second, again);
  again.load(ConfigFile(settings.toml(), "printed"));
  EXPECT_EQ(again.toml(), settings.toml());
  EXPECT_EQ(second.drive, first.drive);
  EXPECT_EQ(second.drive, "my \"robot\"\\");
  EXPECT_EQ(second.loss, 0.125);
  EXPECT_EQ(second.colour, Colour::kGreen);
}

TEST(Settings, ThePrintedDefaultsReadBackToo) {
  Sample first, second;
  Settings settings, again;
  declare(first, settings);
  declare(second, again);
  again.load(ConfigFile(settings.toml(), "printed"));  // its lists are empty
  EXPECT_EQ(again.toml(), settings.toml());
}

TEST(Settings, HelpShowsTypeUnitBoundsAndDefaultOfEverything) {
  Sample sample;
  Settings settings;
  declare(sample, settings);
  const std::string help = settings.help();
  for (const char* line : {"--stream-hz NUMBER", "stream rate (100 to 10000 Hz) [1000]", "--block INTEGER",
                           "(4 to 64) [16]", "--colour red|green", "of the beam [red]", "like a heart",
                           "--robot ROBOT", "--drive simulated|udp:HOST:PORT", "--start 2 NUMBERS"})
    EXPECT_NE(help.find(line), std::string::npos) << line << "\n" << help;
  const auto json = settings.json();
  EXPECT_EQ(
      json.at(0).dump(),
      R"({"name":"stream_hz","flag":"--stream-hz","type":"number","min":100.0,"max":10000.0,"unit":"Hz",)"
      R"("default":1000.0,"sentence":"stream rate"})");
  EXPECT_EQ(json.at(5).at("choices").at(1).at("word"), "green");
  EXPECT_FALSE(json.at(6).contains("default")) << "of what is not set";
}

}  // namespace
}  // namespace telekerf
