// SPDX-License-Identifier: Apache-2.0
// Every path that the README names exists.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace telekerf::integration {
namespace {

TEST(Readme, EveryPathItNamesExists) {
  const std::filesystem::path root = TELEKERF_SOURCE_DIR;
  std::ifstream in(root / "README.md");
  std::stringstream text;
  text << in.rdbuf();
  const std::string readme = text.str();
  ASSERT_GT(readme.size(), 1000u);
  // In backticks or as a link's target: something with a slash that is no option, address or product of a build.
  const std::regex path(R"re((?:`|\]\()([A-Za-z0-9_.-]+/[A-Za-z0-9_./-]*)[`)])re");
  int named = 0;
  for (std::sregex_iterator at(readme.begin(), readme.end(), path), end; at != end; ++at) {
    const std::string name = (*at)[1];
    if (name.starts_with("build/") || name.starts_with("out/") || name.starts_with("./")) continue;
    ++named;
    EXPECT_TRUE(std::filesystem::exists(root / name)) << name;
  }
  EXPECT_GT(named, 10);
}

}  // namespace
}  // namespace telekerf::integration
