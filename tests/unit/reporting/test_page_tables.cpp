// SPDX-License-Identifier: Apache-2.0
// Tables of pages: written between their comments, read back, refused where they have no place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/reporting/page_tables.h"
#include "common/runtime/startup_error.h"

namespace telekerf::reporting {
namespace {

class Page : public testing::Test {
 protected:
  Page() {
    std::ofstream(file_) << "Before.\n<!-- table a -->\nold\n<!-- end of a -->\nBetween.\n"
                            "<!-- table b -->\n<!-- end of b -->\nAfter.\n";
  }
  ~Page() override { std::filesystem::remove(file_); }
  std::string text() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }
  std::string refusal_of(const std::string& name) const {
    try {
      write_tables(file_, {{name, "x"}});
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  }
  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("page-" + std::to_string(::getpid()) + ".md");
};

TEST_F(Page, HoldsWhatWasWrittenAndNothingElseChanges) {
  const TableRows first{{"law", "0"}, {"one", "1.5"}, {"two, odd", ""}};
  const TableRows second{{"x"}, {"y"}};
  for (int twice = 0; twice < 2; ++twice)
    write_tables(file_, {{"b", markdown_table(second)}, {"a", markdown_table(first)}});
  EXPECT_EQ(text(),
            "Before.\n<!-- table a -->\n\n| law | 0 |\n| --- | --- |\n| one | 1.5 |\n| two, odd |  |\n\n"
            "<!-- end of a -->\nBetween.\n<!-- table b -->\n\n| x |\n| --- |\n| y |\n\n<!-- end of b "
            "-->\nAfter.\n");
  EXPECT_EQ(read_table(file_, "a"), first);
  EXPECT_EQ(read_table(file_, "b"), second);
}

TEST_F(Page, WithoutAPlaceForTheTableIsRefusedAndLeftAsItWas) {
  const std::string before = text();
  EXPECT_EQ(refusal_of("c"), file_.string() +
                                 ": no place for the table 'c': it wants the lines '<!-- table c -->' "
                                 "and '<!-- end of c -->'");
  EXPECT_EQ(text(), before);
  EXPECT_THROW((void)read_table(file_, "c"), StartupError);
  EXPECT_THROW((void)read_table(file_.string() + ".none", "a"), StartupError);
}

}  // namespace
}  // namespace telekerf::reporting
