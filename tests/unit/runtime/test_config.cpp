// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/runtime/config.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "no refusal";
}

TEST(Config, ReadsNestedKeysAndArraysOfTables) {
  const ConfigFile file("a.b = 3\nlist = [1, 2.5]\n[[stage]]\nx = 1\n[[stage]]\nx = 2\n", "f.toml");
  EXPECT_EQ(file.integer("a.b"), 3);
  EXPECT_EQ(file.numbers("list", 2), (std::vector<double>{1, 2.5}));
  ASSERT_EQ(file.array_size("stage"), 2u);
  EXPECT_EQ(file.number("stage.0.x"), 1);
  EXPECT_EQ(file.number("stage.1.x"), 2);
  file.refuse_unknown();
}

TEST(Config, RefusalNamesFileKeyValueAndBound) {
  const ConfigFile file("gain_hz = -4.0\n", "f.toml");
  const auto text = refusal_of([&] { (void)file.number("gain_hz", {.min = 0, .max = 10}); });
  EXPECT_EQ(text, "f.toml: gain_hz = -4.0: must lie within [0, 10]");
}

TEST(Config, ARefusedListStandsInOneLine) {
  const ConfigFile file("list = [0.25, nan, 3]\ntables = [{a = 1}]\n", "f.toml");
  EXPECT_EQ(refusal_of([&] { (void)file.numbers("list", 3); }),
            "f.toml: list = [0.25, nan, 3]: must be a finite number");
  EXPECT_EQ(refusal_of([&] { (void)file.numbers("tables", 0); }),
            "f.toml: tables = [{..}]: must hold numbers only");
}

TEST(Config, AFileThatIsNotThereIsNamed) {
  EXPECT_EQ(refusal_of([] { ConfigFile(std::filesystem::path("nowhere.toml")); }),
            "nowhere.toml: cannot be read; is the name right?");
}

TEST(Config, UnknownKeysAreRefusedByName) {
  const ConfigFile file("known = 1\n[t]\ntypo = 2\n", "f.toml");
  (void)file.number("known");
  EXPECT_NE(refusal_of([&] { file.refuse_unknown(); }).find("unknown key 't.typo'"), std::string::npos);
  const ConfigFile other("[t]\nrate = 0.1\ntypo = 2\n", "f.toml");
  (void)other.number("t.rate");
  (void)other.number_or("u.far", 0.0);
  EXPECT_EQ(refusal_of([&] { other.refuse_unknown(); }), "f.toml: unknown key 't.typo'; known here: rate");
  EXPECT_EQ(refusal_of([&] { other.refuse("t.rate", "too low"); }), "f.toml: t.rate = 0.1: too low");
  EXPECT_EQ(refusal_of([&] { other.refuse("t", "wrong"); }), "f.toml: t: wrong");
}

TEST(Config, WrongTypesAndMissingKeysAreRefused) {
  const ConfigFile file("n = 'text'\nb = true\nnot_finite = nan\nlist = [1]\n", "f.toml");
  for (const auto* key : {"n", "b", "not_finite", "absent"}) {
    EXPECT_NE(refusal_of([&] { (void)file.number(key); }).find(key), std::string::npos) << key;
  }
  EXPECT_NE(refusal_of([&] { (void)file.numbers("list", 3); }).find("3 numbers"), std::string::npos);
}

TEST(Config, SyntaxErrorsNameTheLine) {
  EXPECT_NE(refusal_of([] { ConfigFile("a = 1\nb = = 2\n", "f.toml"); }).find("line 2"), std::string::npos);
}

}  // namespace
}  // namespace telekerf
