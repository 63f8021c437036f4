// SPDX-License-Identifier: Apache-2.0
// The small parts that every program stands on: bounds, error figures, device names, addresses, results.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "common/runtime/bounds.h"
#include "common/runtime/device_registry.h"
#include "common/runtime/error_statistics.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/setting.h"
#include "common/runtime/udp.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

template <typename Action>
std::pair<std::string, ErrorKind> refusal(const Action& action) {
  try {
    action();
  } catch (const StartupError& error) {
    return {error.what(), error.kind()};
  }
  return {"no refusal", ErrorKind::kHardware};
}

TEST(Bounds, AreInclusive) {
  const Bounds bounds{.min = -2, .max = 3, .unit = "mm"};
  for (const double good : {-2.0, 3.0, 0.0}) EXPECT_EQ(complaint_about(good, bounds), "");
  for (const double bad : {std::nextafter(-2.0, -3.0), std::nextafter(3.0, 4.0)})
    EXPECT_EQ(complaint_about(bad, bounds), "must lie within [-2, 3] mm");
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_EQ(complaint_about(none, {}), "must be a finite number");
  EXPECT_EQ(complaint_about(4, {.min = 0, .max = 3}), "must lie within [0, 3]");
  EXPECT_EQ(range_text(bounds), "-2 to 3 mm");
  EXPECT_EQ(range_text({.min = 1}), "at least 1");
  EXPECT_EQ(range_text({.max = 1, .unit = "s"}), "at most 1 s");
  EXPECT_EQ(range_text({.unit = "s"}), "s");
  EXPECT_EQ(range_text({}), "");
  EXPECT_EQ(complaint_about(1e15, kSeeds), "");
  EXPECT_NE(complaint_about(1e15 + 1, kSeeds), "");
}

TEST(ErrorStatistics, OfSignedErrors) {
  ErrorStatistics errors;
  EXPECT_EQ(errors.rms(), 0.0);
  for (const double error : {3.0, -5.0, 1.0, 1.0}) errors.add(error);
  EXPECT_DOUBLE_EQ(errors.rms(), 3.0);
  EXPECT_EQ(errors.max, 5.0);
  EXPECT_EQ(errors.count, 4u);
}

TEST(DeviceRegistry, TakesWhatStandsBeforeTheFirstColon) {
  using Registry = DeviceRegistry<std::string, int>;
  static constexpr Registry::Kind kKinds[] = {
      {"plain", "plain", no_argument,
       [](std::string_view rest, int n) { return std::to_string(n).append(rest); }},
      {"udp", "udp:HOST:PORT", validate_udp,
       [](std::string_view rest, int n) { return std::string(rest) + std::to_string(n); }}};
  const Registry registry("drive", kKinds);
  EXPECT_EQ(registry.forms(), "plain, udp:HOST:PORT");
  EXPECT_EQ(registry.open("plain", 7), "7");
  EXPECT_EQ(registry.open("udp:10.0.0.1:7000", 1), "10.0.0.1:70001");
  EXPECT_EQ(registry.validate("plain"), "");
  EXPECT_EQ(registry.validate("plain:x"), "stands alone, nothing follows its name");
  EXPECT_EQ(registry.validate("plai"),
            "must be one of plain, udp:HOST:PORT; docs/how-to says how to add another");
  EXPECT_EQ(refusal([&] { (void)registry.open("plain:x", 1); }),
            std::pair(std::string("drive = plain:x: stands alone, nothing follows its name"),
                      ErrorKind::kConfiguration));
  EXPECT_EQ(device_form(registry.forms(), {}).form, "plain|udp:HOST:PORT");
}

TEST(Udp, AddressesAreHostAndPort) {
  const auto parts = [](std::string_view text) {
    const UdpAddress address = udp_address(text);
    return address.host + " " + std::to_string(address.port);
  };
  EXPECT_EQ(parts("127.0.0.1:7000"), "127.0.0.1 7000");
  EXPECT_EQ(parts("::1:5"), "::1 5") << "the last colon counts";
  EXPECT_EQ(parts("host"), "host 0");
  EXPECT_EQ(parts("host:65535"), "host 65535");
  for (const char* bad : {"host:65536", "host:-1", "host:", "host:7x", "host: 7"})
    EXPECT_EQ(parts(bad), "host 0") << bad;
  EXPECT_EQ(validate_udp("host:1"), "");
  for (const char* bad : {"", "host", ":7000", "host:0", "host:70000"})
    EXPECT_EQ(validate_udp(bad), "udp needs a host and a port within [1, 65535], as in udp:127.0.0.1:7000")
        << bad;
  EXPECT_EQ(refusal([] {
              refuse_udp({"h", 5}, "laser", "gone", "plug it in");
            }),
            std::pair(std::string("laser = udp:h:5: gone; plug it in"), ErrorKind::kHardware));
}

struct Folder {
  Folder() : path(fs::path(testing::TempDir()) / ("telekerf-parts-" + std::to_string(::getpid()))) {
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

TEST(Results, AreWrittenWholeIntoFoldersThatAreMade) {
  const Folder folder;
  const fs::path file = folder.path / "deep" / "er" / "text.txt";
  write_atomically(file, "one\n");
  write_atomically(file, "two\n");
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_EQ(text.str(), "two\n");
  EXPECT_FALSE(fs::exists(file.string() + ".part"));
  const fs::path taken = folder.path / "taken" / "x";
  fs::create_directories(taken);
  EXPECT_EQ(refusal([&] { write_atomically(folder.path / "taken", "three"); }).second,
            ErrorKind::kEnvironment);
  EXPECT_FALSE(fs::exists(folder.path / "taken.part")) << "no draft is left";

  // A link stays one; a pipe gets what is written.
  fs::create_symlink(file, folder.path / "link");
  write_atomically(folder.path / "link", "three\n");
  EXPECT_TRUE(fs::is_symlink(folder.path / "link"));
  EXPECT_EQ(fs::file_size(file), 6U);
  const fs::path pipe = folder.path / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  write_atomically(pipe, "four\n");
  char heard[8] = {};
  EXPECT_EQ(::read(reader, heard, sizeof heard), 5);
  ::close(reader);
  EXPECT_STREQ(heard, "four\n");
  EXPECT_TRUE(fs::is_fifo(pipe));

  EXPECT_EQ(refusal([] { refuse_unwritable("--out", ""); }),
            std::pair(std::string("--out is empty: name a folder for the results"), ErrorKind::kUsage));
  refuse_unwritable("--out", folder.path / "not" / "yet");
  EXPECT_FALSE(fs::exists(folder.path / "not")) << "asking makes none";
  make_folder("--out", folder.path / "not" / "yet");
  EXPECT_TRUE(fs::is_directory(folder.path / "not" / "yet"));
  make_folder("--out", folder.path / "not" / "yet");
  const std::string wrong = refusal([&] { make_folder("--out", file / "below"); }).first;
  EXPECT_EQ(wrong, "--out " + (file / "below").string() + ": " + file.string() +
                       " is no folder; name another folder");
  write_json(folder.path / "j.json", nlohmann::ordered_json{{"a", 1}, {"b", "\xff"}});
  std::ostringstream json;
  json << std::ifstream(folder.path / "j.json").rdbuf();
  EXPECT_EQ(json.str(), "{\n  \"a\": 1,\n  \"b\": \"\xEF\xBF\xBD\"\n}\n");
}

TEST(Resources, AFileStandsBeforeWhatIsShipped) {
  const Folder folder;
  fs::create_directories(folder.path / "things");
  for (const char* name : {"b.toml", "a.toml", "c.txt"}) std::ofstream(folder.path / "things" / name) << "x";
  ASSERT_EQ(setenv("TELEKERF_DATA", folder.path.c_str(), 1), 0);
  EXPECT_EQ(shipped_names("things", ".toml"), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(shipped_names("nothing", ".toml").empty());
  EXPECT_EQ(find_resource("things", "a", ".toml"), folder.path / "things" / "a.toml");
  const std::string own = (folder.path / "things" / "c.txt").string();
  EXPECT_EQ(find_resource("things", own, ".toml"), own);
  EXPECT_EQ(
      refusal([] { (void)find_resource("things", "c", ".toml"); }),
      std::pair(std::string("'c' is neither a file nor one of the shipped things: a, b"), ErrorKind::kInput));
  EXPECT_EQ(refusal([] { (void)find_resource("nothing", "../things/a", ".toml"); }).second, ErrorKind::kInput)
      << "a name is no way";
  unsetenv("TELEKERF_DATA");
}

}  // namespace
}  // namespace telekerf
