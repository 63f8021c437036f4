// SPDX-License-Identifier: Apache-2.0
// Recorded runs are read by another process: what it is told, what becomes of its answer, and of one that hangs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "master/console/run_shelf.h"

namespace telekerf::master {
namespace {

using std::chrono::milliseconds;

TEST(RunQuestion, IsOneOfTheTwoAddressesAndLeavesNoFolder) {
  RunQuestion question;
  EXPECT_FALSE(parse_run_question("/runner", question));
  EXPECT_FALSE(parse_run_question("/run/one", question));
  ASSERT_TRUE(parse_run_question("/runs", question));
  EXPECT_TRUE(question.name.empty() && question.what.empty());
  ASSERT_TRUE(parse_run_question("/run?what=master.csv&name=cut%20two", question));
  EXPECT_EQ(question.name, "cut two");
  EXPECT_EQ(question.what, "master.csv");
  ASSERT_TRUE(parse_run_question("/run?name=one", question));
  EXPECT_EQ(question.what, "playback");
  for (const char* name : {"..", ".hidden", "a%2Fb", "a/b", "%00", "%2", "%zz", ""}) {
    ASSERT_TRUE(parse_run_question(std::string("/run?name=") + name, question));
    EXPECT_EQ(question.name, "") << name;
  }
  for (const char* what : {"--out=x", "-h", "a%20b", "A", "a/b"}) {
    ASSERT_TRUE(parse_run_question(std::string("/run?name=one&what=") + what, question));
    EXPECT_EQ(question.what, "") << what;
  }
}

class RunShelfTest : public ::testing::Test {
 protected:
  RunShelfTest() { std::filesystem::create_directories(folder_); }
  ~RunShelfTest() override { std::filesystem::remove_all(folder_); }

  /// A program in telekerf-inspect's place.
  std::filesystem::path program(const std::string& script) {
    const std::filesystem::path file = folder_ / "inspect";
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    ::chmod(file.c_str(), 0700);
    return file;
  }
  RunShelf::Answer ask(RunShelf& shelf, const RunQuestion& question) {
    std::optional<RunShelf::Answer> answer;
    shelf.ask(question, [&](RunShelf::Answer given) { answer = std::move(given); });
    EXPECT_FALSE(answer) << "not before the caller goes on";
    context_.restart();
    context_.run();
    return answer.value_or(RunShelf::Answer{0, "no answer"});
  }

  boost::asio::io_context context_;
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("shelf-" + std::to_string(::getpid()));
};

TEST_F(RunShelfTest, TellsWhatIsMeantAndGivesItsBytes) {
  RunShelf shelf(context_, {.folder = "/runs", .inspect = program("echo \"$@\"; head -c 300000 /dev/zero; echo warning >&2")});
  const auto list = ask(shelf, {});
  EXPECT_EQ(list.status, 200);
  EXPECT_EQ(list.bytes.substr(0, list.bytes.find('\n')), "runs /runs --json");
  EXPECT_EQ(list.bytes.size(), 300'000 + sizeof("runs /runs --json"));
  const auto one = ask(shelf, {.name = "cut two", .what = "master.csv"});
  EXPECT_EQ(one.bytes.substr(0, one.bytes.find('\n')), "export /runs/cut two master.csv");
}

TEST_F(RunShelfTest, ARefusalIsPassedOnAndACrashIsNamed) {
  RunShelf refusing(context_, {.folder = ".", .inspect = program("echo half; echo 'no such run' >&2; exit 2")});
  const auto refused = ask(refusing, {.name = "a", .what = "b"});
  EXPECT_EQ(refused.status, 404);
  EXPECT_EQ(refused.bytes, "no such run\n");
  RunShelf crashing(context_, {.folder = ".", .inspect = program("kill -SEGV $$")});
  EXPECT_EQ(ask(crashing, {}).status, 404);
  RunShelf missing(context_, {.folder = ".", .inspect = folder_ / "nowhere"});
  EXPECT_EQ(ask(missing, {}).status, 404);
  EXPECT_EQ(ask(missing, {.name = "a", .what = ""}).status, 404);
  EXPECT_EQ(ask(missing, {.name = "", .what = "b"}).status, 404);
}

TEST_F(RunShelfTest, OneThatHangsIsEndedAndTheNextIsAnswered) {
  RunShelf shelf(context_, {.folder = ".", .inspect = program("[ \"$1\" = export ] && exec sleep 60; echo list"),
                            .patience = milliseconds(300)});
  EXPECT_EQ(ask(shelf, {.name = "a", .what = "b"}).status, 504);
  EXPECT_EQ(ask(shelf, {}).bytes, "list\n");
  // Its outputs are closed, and still it does not end.
  RunShelf closed(context_, {.folder = ".", .inspect = program("exec sleep 60 >&- 2>&-"), .patience = milliseconds(300)});
  EXPECT_EQ(ask(closed, {}).status, 504);
}

TEST_F(RunShelfTest, SeveralReadAtTheSameTimeAndOfVeryManyTheLastAreRefused) {
  // Each waits for the others: one after the other they would give up.
  RunShelf shelf(context_, {.folder = ".",
                            .inspect = program("d=$(dirname $0); : >$d/here.$$; n=0\n"
                                               "while [ $(ls $d | grep -c here) -lt 3 ]; do\n"
                                               "  sleep 0.05; n=$((n + 1)); [ $n -lt 100 ] || exit 1\n"
                                               "done; echo list")});
  std::vector<int> answers;
  for (std::size_t n = 0; n < RunShelf::kAtOnce + RunShelf::kMostWaiting + 2; ++n)
    shelf.ask({}, [&](RunShelf::Answer answer) { answers.push_back(answer.status); });
  context_.run();
  std::vector<int> expected(RunShelf::kAtOnce + RunShelf::kMostWaiting, 200);
  expected.insert(expected.begin(), 2, 503);
  EXPECT_EQ(answers, expected);
  Metrics figures;
  shelf.add_figures(figures);
  EXPECT_EQ(figures["runs_read"], 15.0);
  EXPECT_EQ(figures["runs_refused"], 2.0);
}

TEST_F(RunShelfTest, WhatWaitsIsAnsweredWhenTheConsoleEnds) {
  std::vector<int> answers;
  {
    RunShelf shelf(context_, {.folder = ".", .inspect = program("exec sleep 60")});
    for (int n = 0; n < 5; ++n) shelf.ask({}, [&](RunShelf::Answer answer) { answers.push_back(answer.status); });
  }
  context_.run();
  EXPECT_EQ(answers, std::vector<int>(5, 503));
}

}  // namespace
}  // namespace telekerf::master
