// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"

namespace telekerf {
namespace {

struct Options {
  int block = 16;
  std::string file;
};

void add_parameters(Options& options, Settings& settings) {
  settings.add("block", options.block, {.min = 4, .max = 64}, "samples a block");
  settings.add("file", options.file, kFile, "what is read").as_argument();
}

struct Ended {
  int code = 0;
  std::string out;
  std::string err;
};

Ended ended(Program& program, std::vector<std::string> words) {
  words.insert(words.begin(), "program");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Ended result;
  result.code = program.run(static_cast<int>(argv.size()), argv.data());
  std::fflush(nullptr);
  result.out = testing::internal::GetCapturedStdout();
  result.err = testing::internal::GetCapturedStderr();
  return result;
}

Ended two_commands(const std::vector<std::string>& words) {
  Program program("telekerf-sample", "Shows how");
  program.add("count", "Counts", Options{}, add_parameters,
              [](const Options& o) { return o.block == 5 ? 1 : 0; });
  program.add("refuse", "Refuses", Options{}, add_parameters, [](const Options& o) -> int {
    if (o.block == 64) throw std::runtime_error("lost");
    throw input_error(o.file + ": empty; give another");
  });
  return ended(program, words);
}

TEST(Program, RunsTheChosenCommandAndReturnsItsVerdict) {
  EXPECT_EQ(two_commands({"count", "a.csv"}).code, 0);
  EXPECT_EQ(two_commands({"count", "a.csv", "--block", "5"}).code, 1);
  EXPECT_EQ(two_commands({"--block", "5", "count", "a.csv"}).code, 1)
      << "settings may stand before the command";
}

TEST(Program, HasNoTwoCommandsOfOneName) {
  Program program("telekerf-sample", "Shows how");
  const auto nothing = [](int&, Settings&) {};
  program.add("look", "Looks", 0, nothing, [](int) { return 0; });
  EXPECT_THROW(program.add("look", "Looks elsewhere", 0, nothing, [](int) { return 0; }), std::logic_error);
}

TEST(Program, WhatCannotBeDoneIsOneSentenceAndTwo) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls = {
      {{"refuse", "a.csv"}, "a.csv: empty; give another"},
      {{"refuse", "a.csv", "--block", "64"}, "unexpected: lost"},
      {{"refuse"}, "command line: file is missing: what is read"},
      {{"refuse", "a.csv", "--block", "3"}, "command line: block = 3: must lie within [4, 64]"},
      {{"guess"}, "there is no command 'guess'; see --help"},
      {{}, "say what to do: count, refuse; see --help"},
  };
  for (const auto& [words, sentence] : calls) {
    const Ended call = two_commands(words);
    EXPECT_EQ(call.code, 2) << sentence;
    EXPECT_EQ(call.err, "telekerf-sample: " + sentence + "\n");
    EXPECT_EQ(call.out, "");
  }
}

TEST(Program, HelpVersionAndTheFileAreOnStandardOutput) {
  EXPECT_NE(two_commands({"--help"}).out.find("  count             Counts\n"), std::string::npos);
  const Ended help = two_commands({"count", "--help", "--block", "99"});
  EXPECT_EQ(help.code, 0) << "whatever else is said";
  EXPECT_NE(help.out.find("Usage: telekerf-sample count file [OPTIONS]"), std::string::npos) << help.out;
  EXPECT_NE(help.out.find("--block INTEGER"), std::string::npos);
  EXPECT_NE(help.out.find("--print-config"), std::string::npos);
  EXPECT_EQ(two_commands({"count", "--version"}).out, std::string(kVersion) + "\n");
  EXPECT_EQ(two_commands({"count", "--block", "8", "--print-config"}).out,
            "# samples a block (4 to 64)\nblock = 8\n");
}

TEST(Program, DescribesAllOfItself) {
  const auto json = nlohmann::json::parse(two_commands({"--describe-settings"}).out);
  EXPECT_EQ(json.at("program"), "telekerf-sample");
  ASSERT_EQ(json.at("commands").size(), 2U);
  EXPECT_EQ(json.at("commands").at(1).at("command"), "refuse");
  EXPECT_EQ(json.at("commands").at(0).at("settings").at(0).at("default"), 16);
}

TEST(Program, OneThatDoesOneThingTakesNoCommand) {
  Program program("telekerf-one", "Does it");
  program.add("", "Does it", Options{}, add_parameters,
              [](const Options& o) { return o.file == "count" ? 1 : 0; });
  EXPECT_EQ(ended(program, {"count"}).code, 1);
  EXPECT_NE(ended(program, {"--help"}).out.find("Usage: telekerf-one file [OPTIONS]"), std::string::npos);
}

}  // namespace
}  // namespace telekerf
