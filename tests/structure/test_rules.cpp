// SPDX-License-Identifier: Apache-2.0
// Each rule finds what breaks it, in a repository of a few lines, and leaves what keeps it alone.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

const std::string kLicence = "// SPDX-License-Identifier: Apache-2.0\n";

Rooms three_rooms() {
  return Rooms(
      "# a comment\n"
      "common/low :\n"
      "common/high : common/low\n"
      "master : common/high\n"
      "master/main.cpp : master netem\n"
      "netem : common/low\n");
}

TEST(Rooms, TheLongestRowCountsAndArrowsAddUp) {
  const Rooms rooms = three_rooms();
  EXPECT_EQ(rooms.room_of("common/low/deep/a.h"), "common/low");
  EXPECT_EQ(rooms.room_of("common/lower/a.h"), "");
  EXPECT_EQ(rooms.room_of("master/main.cpp"), "master/main.cpp");
  EXPECT_TRUE(rooms.allows("master", "common/low"));
  EXPECT_FALSE(rooms.allows("common/low", "master"));
  EXPECT_FALSE(rooms.allows("master", "netem"));
  EXPECT_TRUE(rooms.allows("master/main.cpp", "netem"));
}

TEST(Rooms, ATableThatIsNoneIsRefused) {
  EXPECT_THROW(Rooms("a b\n"), std::runtime_error);
  EXPECT_THROW(Rooms("a :\na :\n"), std::runtime_error) << "twice";
  EXPECT_THROW(Rooms("a : b\n"), std::runtime_error) << "b has no row";
  EXPECT_THROW(Rooms("a : b\nb : c\nc : a\n"), std::runtime_error) << "a cycle";
}

TEST(Rules, AnUpwardArrowIsFound) {
  Repository tree{{{"common/low/a.h", ""}, {"common/high/b.h", "#include \"common/low/a.h\"\n"}}};
  EXPECT_TRUE(upward_arrows(tree, three_rooms()).empty());
  tree.files["common/low/a.h"] = "#include \"common/high/b.h\"\n";
  EXPECT_EQ(upward_arrows(tree, three_rooms()), Breaches{"common/low/a.h includes common/high/b.h"});
}

TEST(Rules, AnArrowBetweenNeighboursIsFoundHoweverItIsWritten) {
  const Repository tree{{{"netem/link.h", ""}, {"master/a.h", "  #  include \"../netem/link.h\" // why\n"}}};
  EXPECT_EQ(upward_arrows(tree, three_rooms()).size(), 1u);
}

TEST(Rules, NamesThatCollideInOneLibraryAreFound) {
  const auto in = [](const std::string& code) {
    return "namespace telekerf {\nnamespace {\n" + code + "\n}\n}\n";
  };
  const auto found = [&](const std::string& one, const std::string& other) {
    return colliding_names(
        Repository{{{"common/low/CMakeLists.txt", "telekerf_library(low SOURCES a.cpp b.cpp LINK x)"},
                    {"common/low/a.cpp", in(one)},
                    {"common/low/b.cpp", in(other)}}});
  };
  EXPECT_EQ(found("constexpr int kMost = 3;", "constexpr double kMost = 4.0;"),
            Breaches{"common/low/b.cpp and common/low/a.cpp of one library both define telekerf::::kMost"});
  EXPECT_EQ(found("constexpr std::array kRows{1, 2};", "const char* const kRows[] = {\"a\"};").size(), 1u);
  EXPECT_EQ(found("struct Row { int a; };", "class Row : Base { };").size(), 1u);
  EXPECT_EQ(found("double norm(double a, int b = 2) { return a; }", "double norm(double c, int d) {}").size(),
            1u);
  EXPECT_TRUE(found("double norm(double a) { return a; }", "double norm(int a) { return a; }").empty())
      << "overloads";
  EXPECT_TRUE(found("void f() { const int kInside = 1; }", "void g() { const int kInside = 1; }").empty())
      << "in bodies";
  const auto program = [&](const std::string& more) {
    return colliding_names(
        Repository{{{"tools/a/CMakeLists.txt", "telekerf_program(a SOURCES a.cpp b.cpp LINK x)" + more},
                    {"tools/a/a.cpp", in("struct Options { };")},
                    {"tools/a/b.cpp", in("struct Options { };")}}});
  };
  EXPECT_EQ(program("").size(), 1u);
  EXPECT_TRUE(program("\nset_target_properties(a PROPERTIES UNITY_BUILD OFF)").empty());
  EXPECT_TRUE(found("constexpr int kOne = 1;", "constexpr int kTwo = 2; // kOne = 1;").empty());
  EXPECT_TRUE(
      colliding_names(Repository{{{"common/low/CMakeLists.txt",
                                   "telekerf_library(a SOURCES a.cpp)\ntelekerf_library(b SOURCES b.cpp)"},
                                  {"common/low/a.cpp", in("constexpr int kMost = 3;")},
                                  {"common/low/b.cpp", in("constexpr int kMost = 3;")}}})
          .empty())
      << "of two libraries";
}

TEST(Rules, ASourceWithoutARoomIsFound) {
  const Repository tree{{{"garage/a.h", ""}}};
  EXPECT_EQ(upward_arrows(tree, three_rooms()).size(), 1u);
}

TEST(Rules, ACycleOfFilesOrOfRoomsIsFound) {
  const Repository files{{{"common/low/a.h", "#include \"common/low/b.h\"\n"},
                          {"common/low/b.h", "#include \"common/low/c.h\"\n"},
                          {"common/low/c.h", "#include \"common/low/a.h\"\n"}}};
  EXPECT_EQ(include_cycles(files, three_rooms()),
            Breaches{"common/low/a.h -> common/low/b.h -> common/low/c.h -> common/low/a.h"});
  const Repository rooms{{{"common/low/a.h", "#include \"common/high/b.h\"\n"},
                          {"common/low/c.h", ""},
                          {"common/high/b.h", ""},
                          {"common/high/d.h", "#include \"common/low/c.h\"\n"}}};
  EXPECT_EQ(include_cycles(rooms, three_rooms()), Breaches{"common/high -> common/low -> common/high"});
}

TEST(Rules, AProgramAmongTheLibrariesIsFound) {
  const Repository tree{{{"common/low/a.cpp", "#include <a>\nint main(int argc, char** argv) {\n"},
                         {"common/low/CMakeLists.txt", "telekerf_program(telekerf-low SOURCES a.cpp)\n"},
                         {"common/high/b.cpp", "int domain(int);\n"},
                         {"master/main.cpp", "int main() {\n"}}};
  EXPECT_EQ(programs_in_common(tree).size(), 2u);
}

TEST(Rules, FastDdsOutsideItsRoomsIsFound) {
  const std::string dds = "#include <fastdds/dds/domain/DomainParticipant.hpp>\n";
  Repository tree{{{"common/bus/a.cpp", dds}, {"netem/drivers/dds.cpp", dds}, {"netem/drivers/dds.h", dds}}};
  EXPECT_TRUE(strayed_dds(tree).empty());
  tree.files["netem/drivers/tun.cpp"] = dds;
  EXPECT_EQ(strayed_dds(tree).size(), 1u) << "a second driver";
  tree.files["master/a.cpp"] = dds;
  EXPECT_EQ(strayed_dds(tree).size(), 2u);
}

TEST(Rules, ALongFileIsFoundSoonerOnTheWayToAMotor) {
  const auto lines = [](int count) { return std::string(static_cast<std::size_t>(count), '\n'); };
  const Repository tree{{{"slave/laser/a.cpp", lines(400)},
                         {"slave/laser/b.cpp", lines(401)},
                         {"slave/c.cpp", lines(210)},
                         {"slave/d.cpp", lines(211)},
                         {"common/streaming/e.h", lines(211)},
                         {"docs/f.md", lines(1000)}}};
  EXPECT_EQ(long_files(tree), (Breaches{"common/streaming/e.h has 211 lines, more than 210",
                                        "slave/d.cpp has 211 lines, more than 210",
                                        "slave/laser/b.cpp has 401 lines, more than 400"}));
}

TEST(Rules, ASourceWithoutItsHeaderIsFound) {
  const Repository tree{{{"master/a.cpp", ""},
                         {"master/a.h", ""},
                         {"master/b.cpp", ""},
                         {"master/c_command.cpp", ""},
                         {"master/main.cpp", "int main() {}\n"},
                         {"tests/unit/d.cpp", ""}}};
  EXPECT_EQ(unpaired_files(tree), Breaches{"master/b.cpp has no header of its name beside it"});
}

TEST(Rules, AHeaderWhoseFunctionsAreDefinedElsewhereIsFound) {
  const auto breaks = [](const std::string& header) {
    return !unpaired_files(Repository{{{"master/a.h", header}}}).empty();
  };
  EXPECT_TRUE(breaks("namespace n {\ndouble f(int a = 1);\n}\n"));
  EXPECT_TRUE(breaks("class A {\n public:\n  void f(const std::vector<int>& x) const noexcept;\n};\n"));
  EXPECT_TRUE(breaks("struct A {\n  explicit A(int a);\n  int b{0};\n};\n"));
  EXPECT_FALSE(
      breaks("// void f();\nnamespace n {\ninline int f() {\n  int a(2);\n  g(a);\n  return a;\n}\n}\n"));
  EXPECT_FALSE(
      breaks("class A {\n  virtual ~A() = default;\n  virtual void f() = 0;\n  int g() { return 1; }\n};\n"));
  EXPECT_FALSE(breaks(
      "struct A {\n  std::function<void(int)> f;\n  int (*g)(int);\n  char h = '(';\n  int i = j(1);\n};\n"));
  EXPECT_FALSE(
      breaks("template <class T>\nT f(T);\nusing F = void(int);\ninline constexpr A kA(kB);\nenum class E { "
             "kA, kB };\nE g() { return "
             "E::kA; }\n"));
  EXPECT_FALSE(unpaired_files(Repository{{{"master/a.h", "void f();\n"}}}).empty());
  EXPECT_TRUE(unpaired_files(Repository{{{"master/a.h", "void f();\n"}, {"master/a.cpp", ""}}}).empty());
  EXPECT_TRUE(unpaired_files(Repository{{{"master/commands.h", "void add();\n"}}}).empty());
}

TEST(Rules, AMissingLicenceIsFound) {
  const Repository tree{{{"a.h", "#pragma once\n" + kLicence}, {"b.cpp", kLicence}, {"c.md", "# C\n"}}};
  EXPECT_EQ(missing_licence(tree), Breaches{"a.h does not begin with its licence"});
}

TEST(Rules, AMentionOfWhatIsNotThereIsFound) {
  const auto breaches = [](const std::string& path, const std::string& text) {
    return dead_mentions(Repository{{{path, text},
                                     {"docs/codec.md", ""},
                                     {"master/observer/concept.h", ""},
                                     {"tests/unit/master/test_a.cpp", "// none\n"}}})
        .size();
  };
  for (const char* dead :
       {"see observer.md", "docs/old.md says how", "common/old/thing", "`old.h`", "(tracker.cpp)"}) {
    EXPECT_EQ(breaches("master/a.h", std::string("// ") + dead + "\n"), 1u) << dead;
    EXPECT_EQ(breaches("README.md", std::string(dead) + "\n"), 1u) << dead;
  }
  EXPECT_EQ(breaches("master/a.cpp", "  refuse(\"docs/old.md says how\");\n"), 1u) << "a program prints it";
  EXPECT_EQ(breaches("master/CMakeLists.txt", "set(sources observer/old.h)\n"), 1u);
  EXPECT_EQ(breaches("tests/unit/b.cpp", "// as old.h has it\n"), 1u);

  EXPECT_EQ(breaches("tests/unit/b.cpp", "  run(\"nothing.md\");\n"), 0u) << "a test makes it up";
  for (const char* alive : {"docs/codec.md", "codec.md", "observer/concept.h", "concept.h", "master/observer",
                            "https://example.org/old.md", "<eigen/old.h>", "report.json",
                            "master/observer/*.h", "master/observer/my_estimator.h"}) {
    EXPECT_EQ(breaches("master/a.h", std::string("// ") + alive + "\n"), 0u) << alive;
  }
}

TEST(Rules, AMentionOfAProgramThatIsNoneIsFound) {
  Repository tree{{{"tools/ctl/CMakeLists.txt", "telekerf_program(telekerf-ctl SOURCES main.cpp)\n"},
                   {"README.md", "`telekerf-ctl stop`\n"}}};
  EXPECT_TRUE(dead_programs(tree).empty());
  tree.files["README.md"] = "`telekerf-talk stop`\n";
  EXPECT_EQ(dead_programs(tree), Breaches{"README.md:1 names telekerf-talk, which is no program"});
}

}  // namespace
}  // namespace telekerf::structure
