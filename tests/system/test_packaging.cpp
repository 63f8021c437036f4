// SPDX-License-Identifier: Apache-2.0
// What Debian's packages hold, as far as it can be seen without building them: units, the file of a cell's settings,
// manual pages; and what the service manager and whoever looks hear of running processes.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "tests/system/field_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;
namespace fs = std::filesystem;

constexpr std::array kServices{"slave", "vision", "master", "console"};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string said_by(const std::string& command) {
  const fs::path file = Program::scratch() / "said.txt";
  if (std::system((command + " >'" + file.string() + "' 2>&1").c_str()) != 0) return "failed: " + text_of(file);
  return text_of(file);
}

fs::path debian() { return fs::path(TELEKERF_SOURCE_DIR) / "debian"; }

/// What telekerf-reference writes for the packages.
class Made : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Program reference("telekerf-reference", {TELEKERF_BIN_DIR, "--package", made().string()});
    ASSERT_EQ(reference.wait(seconds(60)), 0) << reference.output();
  }
  static fs::path made() { return Program::scratch() / "made"; }
};

TEST_F(Made, TheCellsFileHoldsEverySettingOfEveryServiceWithItsDefault) {
  const std::string file = text_of(made() / "cell-1.toml");
  const fs::path all = Program::scratch() / "all.toml";
  std::ofstream(all) << std::regex_replace(file, std::regex("(^|\n)#([a-z0-9_]+ = )"), "$1$2");
  for (const std::string service : kServices) {
    const std::string program = "'" TELEKERF_BIN_DIR "/telekerf-" + service + "'";
    const std::string usual = said_by(program + " --print-config");
    EXPECT_EQ(said_by(program + " --config '" + all.string() + "' --print-config"), usual) << service;
    EXPECT_EQ(said_by(program + " --config '" + (made() / "cell-1.toml").string() + "' --print-config"), usual);
    // Its own table, and what stands above all tables.
    const std::size_t table = file.find("\n[" + service + "]\n");
    ASSERT_NE(table, file.npos) << service;
    const std::string own =
        file.substr(0, file.find("\n[")) + file.substr(table, file.find("\n[", table + 2) - table);
    std::istringstream lines(usual);
    for (std::string line; std::getline(lines, line);) {
      const std::string key = line.substr(line.starts_with("# ") ? 2 : 0, line.find(" =") - (line.starts_with("# ") ? 2 : 0));
      if (line.find(" =") == line.npos || key.find(' ') != key.npos || key == "cell") continue;
      EXPECT_NE(own.find("\n#" + key + " ="), own.npos) << service << ": " << key;
    }
  }
}

TEST_F(Made, AManualPageHasEveryFlag) {
  for (const std::string service : kServices) {
    const std::string page = text_of(made() / ("telekerf-" + service + ".1"));
    std::istringstream lines(said_by("'" TELEKERF_BIN_DIR "/telekerf-" + service + "' --help"));
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("  --")) continue;
      std::string flag = line.substr(2, line.find_first_of(" ,", 2) - 2);
      flag = std::regex_replace(flag, std::regex("-"), "\\-");
      EXPECT_NE(page.find("\\fB" + flag + "\\fR"), page.npos) << service << ": " << flag;
    }
  }
}

TEST(Units, AreUnderstoodAndHardened) {
  const fs::path folder = Program::scratch() / "units";
  fs::create_directories(folder);
  for (const auto& entry : fs::directory_iterator(debian() / "units"))
    std::ofstream(folder / entry.path().filename())
        << std::regex_replace(text_of(entry.path()), std::regex("/usr/bin/"), TELEKERF_BIN_DIR "/");
  for (const std::string service : kServices) {
    const std::string unit = "'" + (folder / ("telekerf-" + service + "@.service")).string() + "'";
    EXPECT_EQ(said_by("SYSTEMD_UNIT_PATH='" + folder.string() + "': systemd-analyze verify --man=no " + unit), "");
    // In tenths: 2.0 of 10.
    const std::string score = said_by("systemd-analyze security --offline=true --threshold=20 --no-pager " + unit);
    EXPECT_EQ(score.find("failed"), score.npos) << score;
  }
  for (const std::string site : {"cell", "operator"}) {
    const std::string unit = "'" + (folder / ("telekerf-" + site + "@.target")).string() + "'";
    EXPECT_EQ(said_by("SYSTEMD_UNIT_PATH='" + folder.string() + "': systemd-analyze verify --man=no " + unit), "");
  }
}

TEST(Units, OfRobotsNeverComeBackByThemselves) {
  for (const std::string service : kServices) {
    const std::string unit = text_of(debian() / "units" / ("telekerf-" + service + "@.service"));
    const bool robot = service == "slave" || service == "master";
    EXPECT_EQ(unit.find("\nRestart=no\n") != unit.npos, robot) << service;
    EXPECT_NE(unit.find("\nType=notify\n"), unit.npos) << service;
    EXPECT_NE(unit.find("\nWatchdogSec="), unit.npos) << service;
    EXPECT_NE(unit.find("--config /etc/telekerf/%i.toml --cell %i\n"), unit.npos) << service;
  }
}

TEST(Packages, HaveTheVersionThatStandsInOnePlaceAndTheChangelogSaysWhenItCame) {
  const fs::path source = TELEKERF_SOURCE_DIR;
  EXPECT_EQ(said_by("'" + (source / "telekerf").string() + "' --version"), TELEKERF_PROJECT_VERSION "\n");
  // Changes since then may stand above it under [Unreleased].
  std::smatch newest;
  const std::string changes = text_of(source / "CHANGELOG.md");
  ASSERT_TRUE(std::regex_search(changes, newest, std::regex(R"(\n## \[(\d[^\]]*)\](.*)\n)")));
  EXPECT_EQ(newest[1], TELEKERF_PROJECT_VERSION);
  EXPECT_TRUE(std::regex_match(newest[2].str(), std::regex(R"( - \d{4}-\d{2}-\d{2})")))
      << newest[2] << ": its date";
  for (const auto& entry : fs::recursive_directory_iterator(debian())) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(text_of(entry.path()).find(TELEKERF_PROJECT_VERSION), std::string::npos) << entry.path();
  }
}

TEST(Packages, HoldEveryProgramAndUnit) {
  std::set<std::string> held;
  for (const auto& entry : fs::directory_iterator(debian())) {
    if (entry.path().extension() != ".install" && entry.path().filename() != "not-installed") continue;
    std::ifstream lines(entry.path());
    for (std::string line; std::getline(lines, line);) held.insert(line.substr(0, line.find(' ')));
  }
  std::istringstream names(TELEKERF_PROGRAMS);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == "telekerf-experiment") continue;  // is not built for packages
    EXPECT_TRUE(held.contains("usr/bin/" + name)) << name;
  }
  for (const auto& entry : fs::directory_iterator(debian() / "units"))
    EXPECT_TRUE(held.contains("debian/units/" + entry.path().filename().string())) << entry.path();
}

/// Listens where a service manager would; programs that are started meanwhile speak to it.
class ServiceManager {
 public:
  ServiceManager() : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string path = (Program::scratch() / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    ::unlink(path.c_str());
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) ADD_FAILURE() << path;
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    const timeval wait{.tv_sec = 0, .tv_usec = 100'000};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
  }
  ~ServiceManager() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(fd_);
  }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Whether `what` is said within this time.
  bool hears(const std::string& what, seconds timeout) const {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (std::chrono::steady_clock::now() < end) {
      std::array<char, 256> room{};
      const ssize_t size = ::recv(fd_, room.data(), room.size(), 0);
      if (size > 0 && std::string(room.data(), static_cast<std::size_t>(size)).find(what) != std::string::npos)
        return true;
    }
    return false;
  }
  void forget() const {
    std::array<char, 256> room{};
    while (::recv(fd_, room.data(), room.size(), MSG_DONTWAIT) > 0) {
    }
  }

 private:
  int fd_;
};

class Services : public Field {};

TEST_F(Services, SayThatTheyAreReadyAndGoOn) {
  for (const std::string service : {"telekerf-slave", "telekerf-vision", "telekerf-console"}) {
    const ServiceManager manager;
    const auto program = start(service, service == "telekerf-console" ? std::vector<std::string>{"--port", "0"}
                                                                      : std::vector<std::string>{});
    ASSERT_TRUE(manager.hears("READY=1", seconds(20))) << service << program->output();
    EXPECT_TRUE(manager.hears("WATCHDOG=1", seconds(5))) << service;
    program->interrupt(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    manager.forget();
    EXPECT_FALSE(manager.hears("WATCHDOG=1", seconds(1))) << service << " stands still";
    program->interrupt(SIGCONT);
    EXPECT_TRUE(manager.hears("WATCHDOG=1", seconds(5))) << service;
  }
}

TEST_F(Services, AreSeenByWhoeverLooks) {
  const auto [nobody, word] = say({"look", "--wait-s", "0.5"});
  EXPECT_EQ(nobody, 1);
  EXPECT_TRUE(word.ends_with("nobody in cell 'field' of domain " + own_domain() + "\n")) << word;
  const auto vision = start("telekerf-vision");
  const auto slave = start("telekerf-slave", {"--name", "left"});
  ASSERT_TRUE(slave->says("ready", seconds(20))) << slave->output();
  ASSERT_TRUE(vision->says(" points", seconds(20))) << vision->output();
  const auto [code, text] = say({"look", "--json", "--wait-s", "3"});
  ASSERT_EQ(code, 0) << text;
  const auto all = nlohmann::json::parse(text.substr(text.find('[')));  // behind what is said beside it
  ASSERT_EQ(all.size(), 2u) << text;
  EXPECT_EQ(all[0].at("role"), "slave");
  EXPECT_EQ(all[0].at("name"), "left");
  EXPECT_EQ(all[1].at("role"), "vision");
  for (const auto& one : all) {
    EXPECT_EQ(one.at("version"), TELEKERF_PROJECT_VERSION);
    EXPECT_NE(one.at("host"), "unknown");
    EXPECT_NEAR(one.at("clock_ahead_s").get<double>(), 0.0, 0.1) << "the same computer's clock";
  }
  EXPECT_NE(say({"look"}).second.find("this computer"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::integration
