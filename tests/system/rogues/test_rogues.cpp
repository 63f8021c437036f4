// SPDX-License-Identifier: Apache-2.0
// A secured cell cuts while whoever may not tries to command it: nothing is heard of them, and the cut is
// complete. TELEKERF_TRIES: of each kind (./telekerf check rogues asks for 10,000).
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/security/documents.h"
#include "common/bus/security/openssl.h"
#include "common/bus/security/roles.h"
#include "tests/system/programs.h"
#include "tests/unit/security/store.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;
using security::Store;
using std::chrono::seconds;

int tries() {
  const char* const said = std::getenv("TELEKERF_TRIES");
  return said == nullptr ? 300 : std::atoi(said);
}

/// What the middleware is told of keys, file by file.
struct Keys {
  fs::path identity_ca, certificate, key, permissions_ca, governance, permissions;

  static Keys of(const Store& store, const std::string& cell, const std::string& role) {
    const security::RoleFiles files = security::role_files(store.folder(), cell, role);
    return {store.folder() / "identity_ca.pem",
            files.certificate,
            files.key,
            store.folder() / "permissions_ca.pem",
            security::governance_file(store.folder(), false),
            files.permissions};
  }
  std::vector<std::string> properties() const {
    const std::string identity = "dds.sec.auth.builtin.PKI-DH.",
                      access = "dds.sec.access.builtin.Access-Permissions.";
    const auto file = [](const fs::path& path) { return "=file://" + path.string(); };
    return {"dds.sec.auth.plugin=builtin.PKI-DH",
            "dds.sec.access.plugin=builtin.Access-Permissions",
            "dds.sec.crypto.plugin=builtin.AES-GCM-GMAC",
            identity + "identity_ca" + file(identity_ca),
            identity + "identity_certificate" + file(certificate),
            identity + "private_key" + file(key),
            access + "permissions_ca" + file(permissions_ca),
            access + "governance" + file(governance),
            access + "permissions" + file(permissions)};
  }
};

/// The console's identity with permissions that it has given itself, and an authority that is itself.
Keys self_granted(const Store& store) {
  Keys keys = Keys::of(store, "cell-1", "console");
  const fs::path folder = store.folder() / "rogue";
  fs::create_directories(folder);
  const auto certificate = security::read_certificate(keys.certificate);
  const auto key = security::read_key(keys.key);
  security::Role greedy = *security::find_role("master");
  greedy.name = "console";
  const auto now = std::chrono::system_clock::now();
  keys.permissions = folder / "permissions.smime";
  std::ofstream(keys.permissions) << security::signed_document(
      security::permissions_text("cell-1", greedy, now - security::kDay, now + security::kDay),
      certificate.get(), key.get());
  keys.governance = folder / "governance.smime";
  std::ofstream(keys.governance) << security::signed_document(security::governance_text(false),
                                                              certificate.get(), key.get());
  keys.permissions_ca = keys.certificate;
  return keys;
}

long resident_kib(const std::string& name, const std::string& domain) {
  long most = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream command(entry.path() / "cmdline");
    const std::string words{std::istreambuf_iterator<char>(command), {}};
    if (words.find(name) == words.npos || words.find(domain) == words.npos) continue;
    std::ifstream status(entry.path() / "status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) most = std::max(most, std::atol(line.c_str() + 6));
    }
  }
  return most;
}

class Rogues : public testing::Test {
 protected:
  Rogues() { fs::remove_all(Program::scratch() / "state"); }

  std::vector<std::string> secured(std::vector<std::string> words) const {
    words.insert(words.end(), {"--domain", own_domain(), "--security", store_.folder().string()});
    return words;
  }
  /// Starts a rogue with these keys.
  std::unique_ptr<Program> rogue(const std::vector<std::string>& properties, int count = tries()) const {
    std::vector<std::string> words{own_domain(), "cell-1", std::to_string(count)};
    words.insert(words.end(), properties.begin(), properties.end());
    return std::make_unique<Program>(TELEKERF_ROGUE, words);
  }
  /// What this packet-writer says once it has done its tries.
  static std::string packets(const std::string& mode, int count) {
    Program writer(TELEKERF_PYTHON, {TELEKERF_ROGUE_PACKETS, own_domain(), mode, std::to_string(count)});
    EXPECT_EQ(writer.wait(seconds(120)), 0) << writer.output();
    return writer.output();
  }

  Store store_{{"cell-1", "other"}};
};

TEST_F(Rogues, NothingIsHeardOfThemAndTheCutIsComplete) {
  const std::string out = (Program::scratch() / "rogues").string();
  const bool raw = ::geteuid() == 0;
  const int many = tries();
  Program vision("telekerf-vision", secured({"--image", "heart"}));
  Program slave("telekerf-slave", secured({"--record", out}));
  Program master("telekerf-master", secured({"--record", out, "--engage", "--duration-s",
                                             std::to_string(many > 1000 ? 120 : 32)}));
  ASSERT_TRUE(slave.says("beam on", seconds(30))) << slave.output() << master.output();

  const Store others({"cell-1"});  // the same names, another authority
  const Store ended({"cell-1"});
  for (const char* name : {"identity_ca.pem", "identity_ca.key", "permissions_ca.pem", "permissions_ca.key"})
    ended.copy(store_.folder() / name, ended.folder() / name);
  security::renew_keystore(ended.folder(), {}, seconds(1));
  Keys mixed = Keys::of(others, "cell-1", "master");
  mixed.identity_ca = store_.folder() / "identity_ca.pem";
  mixed.permissions_ca = store_.folder() / "permissions_ca.pem";
  mixed.governance = security::governance_file(store_.folder(), false);
  mixed.permissions = security::role_files(store_.folder(), "cell-1", "master").permissions;
  std::this_thread::sleep_for(seconds(2));

  std::vector<std::pair<std::string, std::unique_ptr<Program>>> rogues;
  rogues.emplace_back("without keys", rogue({}));
  rogues.emplace_back("with another role's", rogue(Keys::of(store_, "cell-1", "console").properties()));
  rogues.emplace_back("with another cell's", rogue(Keys::of(store_, "other", "master").properties()));
  rogues.emplace_back("with another authority's", rogue(Keys::of(others, "cell-1", "master").properties()));
  rogues.emplace_back("with another authority's key and our permissions", rogue(mixed.properties()));
  rogues.emplace_back("with permissions of its own making", rogue(self_granted(store_).properties()));
  rogues.emplace_back("with expired ones", rogue(Keys::of(ended, "cell-1", "master").properties()));
  for (const auto& [kind, each] : rogues) {
    EXPECT_EQ(each->wait(seconds(60)), 0) << kind << each->output();
    const std::string said = each->output();
    EXPECT_TRUE(said.find("refused: no ") != said.npos || said.find("readers 0") != said.npos)
        << kind << ": " << said;
    std::printf("%s: %s", kind.c_str(), said.substr(said.rfind('\n', said.size() - 2) + 1).c_str());
  }
  Program second("telekerf-master", secured({"--engage"}));
  EXPECT_EQ(second.wait(seconds(20)), 2) << "a second master of the same keys: " << second.output();
  EXPECT_NE(second.output().find("a second master"), std::string::npos) << second.output();

  if (raw) {
    for (const char* mode : {"forge", "strip", "replay"})
      std::printf("%s: %s", mode, packets(mode, many).c_str());
    for (const char* mode : {"flood", "known"}) {
      const long before = resident_kib("telekerf-slave", own_domain());
      ASSERT_GT(before, 1000);
      const std::string said = packets(mode, std::max(many, 3000));
      std::this_thread::sleep_for(seconds(1));
      const long more = resident_kib("telekerf-slave", own_domain()) - before;
      std::printf("%s: %s, %ld KiB more\n", mode, said.substr(0, said.find('\n')).c_str(), more);
      EXPECT_LT(more, 16 * 1024) << mode;
    }
  }

  ASSERT_EQ(master.wait(seconds(180)), 0) << master.output() << slave.output().substr(0, 4000);
  // What the rogues did not find is there: the same program with a master's own keys finds it.
  const auto entitled = rogue(Keys::of(store_, "cell-1", "master").properties(), 1);
  EXPECT_EQ(entitled->wait(seconds(60)), 0) << entitled->output();
  EXPECT_NE(entitled->output().find("readers 1"), std::string::npos) << entitled->output();
  slave.interrupt();
  EXPECT_EQ(slave.wait(seconds(10)), 0);
  const auto figures = nlohmann::json::parse(std::ifstream(out + "/slave.json"));
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(60)), 0) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  std::printf("coverage %.3f, tracking %.1f um rms\n%s\n", report["cut"]["coverage"].get<double>(),
              report["tracking"]["rms_um"].get<double>(), figures.dump().substr(0, 3000).c_str());
  EXPECT_GE(report["cut"]["coverage"].get<double>(), 0.95);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  const auto& all = figures.contains("figures") ? figures["figures"] : figures;
  EXPECT_EQ(all["damaged"].get<double>(), 0.0) << "what a rogue wrote was read";
  EXPECT_EQ(all["strangers"].get<double>(), 1.0)
      << "of all of them the one block of a master's own keys was looked at";
  EXPECT_GT(all["unauthenticated"].get<double>(), 0.0);
}

}  // namespace
}  // namespace telekerf::integration
