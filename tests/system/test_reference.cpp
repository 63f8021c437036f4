// SPDX-License-Identifier: Apache-2.0
// The pages and the completion script that stand in the repository are what the programs say of themselves.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;
namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Reference, PagesAreWhatTheProgramsSayOfThemselves) {
  const fs::path out = Program::scratch() / "reference";
  Program reference("telekerf-reference", {TELEKERF_BIN_DIR, "--out", out.string()});
  ASSERT_EQ(reference.wait(seconds(60)), 0) << reference.output();
  for (const char* page :
       {"docs/reference/settings.md", "docs/reference/records.md", "tools/reference/telekerf.bash"}) {
    EXPECT_EQ(text_of(fs::path(TELEKERF_SOURCE_DIR) / page), text_of(out / page))
        << page << ": build/bin/telekerf-reference build/bin --out . writes it anew";
  }
}

/// What bash offers after `line`, its words parted by single blanks.
std::string completed(const std::string& line) {
  std::string words;
  std::istringstream in(line + (line.ends_with(' ') ? "\"\"" : ""));
  std::string word, last, before;
  int count = 0;
  while (in >> word) {
    words += " " + word;
    before = last;
    last = word;
    ++count;
  }
  const fs::path file = Program::scratch() / "completed.txt";
  const std::string script = ". " TELEKERF_SOURCE_DIR "/tools/reference/telekerf.bash; COMP_WORDS=(" + words +
                             "); COMP_CWORD=" + std::to_string(count - 1) +
                             "; _telekerf \"${COMP_WORDS[0]}\" " + last + " " + before +
                             "; echo \"${COMPREPLY[@]}\"";
  if (std::system(("bash -c '" + script + "' >" + file.string() + " 2>&1").c_str()) != 0) return "failed";
  std::string reply = text_of(file);
  reply.pop_back();
  return reply;
}

TEST(Completion, OffersCommandsFlagsAndChoices) {
  EXPECT_EQ(completed("telekerf-master --la"), "--law");
  EXPECT_EQ(completed("telekerf-master --law "), "anchored remote-acceleration local");
  EXPECT_EQ(completed("telekerf-master --law l"), "local");
  EXPECT_EQ(completed("build/bin/telekerf-slave --drive "), "simulated udp:");
  EXPECT_EQ(completed("telekerf-netem ve"), "verify");
  EXPECT_EQ(completed("telekerf-netem verify --pa"), "--packets");
  EXPECT_EQ(completed("telekerf-netem tc wifi --direction b"), "backward");
  EXPECT_EQ(completed("telekerf-vision --image he"), "heart");
  EXPECT_EQ(completed("telekerf-slave --engage"), "") << "the master's flag";
}

}  // namespace
}  // namespace telekerf::integration
