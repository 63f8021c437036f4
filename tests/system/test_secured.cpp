// SPDX-License-Identifier: Apache-2.0
// A cell with keys and one without: what each says at its start, what it refuses, and how a work ends with
// its keys.
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/bus/security/keystore_check.h"
#include "tests/system/machine_noise.h"
#include "tests/system/programs.h"
#include "tests/unit/security/store.h"

namespace telekerf::integration {
namespace {

using security::Store;
using std::chrono::seconds;

std::vector<std::string> secured(const Store& store, std::vector<std::string> words) {
  words.insert(words.end(), {"--domain", own_domain(), "--security", store.folder().string()});
  return words;
}

class SecuredCell : public testing::Test {
 protected:
  SecuredCell() { std::filesystem::remove_all(Program::scratch() / "state"); }
};

TEST_F(SecuredCell, CutsAcrossAnEmulatedNetworkAndHearsItsOperator) {
  const Store store;
  const std::string out = (Program::scratch() / "secured").string();
  Program vision("telekerf-vision",
                 secured(store, {"--image", "heart", "--netem", "thesis-constant", "--wan"}));
  Program slave("telekerf-slave", secured(store, {"--record", out, "--netem", "thesis-constant", "--wan"}));
  Program master("telekerf-master", secured(store, {"--record", out, "--engage", "--duration-s", "12",
                                                    "--netem", "thesis-constant", "--wan"}));
  ASSERT_TRUE(slave.says("beam on", seconds(30))) << slave.output() << master.output();
  Program stop("telekerf-ctl", secured(store, {"disengage", "--wan"}));
  EXPECT_EQ(stop.wait(seconds(20)), 0) << stop.output();
  Program again("telekerf-ctl", secured(store, {"engage", "--wan"}));
  EXPECT_EQ(again.wait(seconds(20)), 0) << again.output();
  ASSERT_EQ(master.wait(seconds(60)), 0) << master.output() << slave.output();
  slave.interrupt();
  EXPECT_EQ(slave.wait(seconds(10)), 0) << slave.output();
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_GE(report["link"]["rtt_ms"]["p50"].get<double>(), 100.0)
      << "no sample is younger than the network lets it be";
  EXPECT_LE(report["link"]["rtt_ms"]["p50"].get<double>(), 110.0);
  EXPECT_GT(slack_of(report) * report["cut"]["coverage"].get<double>(), 0.5);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_NE(slave.output().find("secured: messages are encrypted"), std::string::npos) << slave.output();
  EXPECT_EQ(slave.output().find("middleware:"), std::string::npos) << slave.output();
}

TEST_F(SecuredCell, ManyWhoStartAtTheSameMomentAllFindEachOther) {
  const Store store;
  const std::vector<std::string> roles{"vision", "slave", "master", "console", "ctl", "plant", "recorder"};
  for (int trial = 0; trial < 3; ++trial) {
    std::vector<std::unique_ptr<Program>> crowd;
    for (const std::string& role : roles)
      crowd.push_back(std::make_unique<Program>(
          "bus_neighbours", std::vector<std::string>{own_domain(), store.folder().string(), role,
                                                     std::to_string(roles.size() - 1)}));
    for (const auto& program : crowd) EXPECT_EQ(program->wait(seconds(40)), 0) << program->output();
  }
}

TEST_F(SecuredCell, KeysThatDoNotFitAreToldWithTheRemedy) {
  const Store ours, others;
  Program slave("telekerf-slave", secured(ours, {}));
  Program master("telekerf-master", secured(others, {}));
  for (const Program* const each : {&slave, &master})
    EXPECT_TRUE(
        each->says("and does not prove it: both sides need keys of the same ./telekerf keys", seconds(30)))
        << each->output();
}

TEST_F(SecuredCell, WithoutKeysTheStartSaysSoAndOtherComputersAreNotReached) {
  Program slave("telekerf-slave", {"--domain", own_domain(), "--cell", "bare"});
  ASSERT_TRUE(slave.says("slave: not secured", seconds(20))) << slave.output();
  const auto refused = [](std::vector<std::string> words, const std::string& why) {
    words.insert(words.end(), {"--domain", own_domain(), "--cell", "bare"});
    Program program("telekerf-master", words);
    EXPECT_EQ(program.wait(seconds(20)), 2) << program.output();
    EXPECT_NE(program.output().find(why), std::string::npos) << program.output();
  };
  refused({"--wan"}, "--wan needs --security");
  refused({"--insecure", "--security", "."}, "--insecure and --security do not go together");
  const Store store;
  refused({"--security", store.folder().string()}, "cells/bare/master/cert.pem is not there");
}

TEST_F(SecuredCell, AWorkEndsInOrderBeforeItsKeysDo) {
  const Store store({"cell-1"});
  security::renew_keystore(store.folder(), {}, seconds(22));
  const auto end = security::certificate_end(store.role("master") / "cert.pem");
  Program vision("telekerf-vision", secured(store, {"--image", "heart"}));
  Program slave("telekerf-slave", secured(store, {}));
  Program master("telekerf-master", secured(store, {"--engage"}));
  ASSERT_TRUE(slave.says("beam on", seconds(15))) << slave.output() << master.output();
  EXPECT_TRUE(master.says("the identity of this master ends on", seconds(2))) << master.output();
  ASSERT_TRUE(master.says("guiding the hand; the slave does not follow", seconds(25))) << master.output();
  EXPECT_LT(std::chrono::system_clock::now(), *end) << "let go before the end";
  EXPECT_EQ(master.wait(seconds(20)), 2) << master.output();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_NE(master.output().find("telekerf-master: the identity of this master has ended on"),
            std::string::npos)
      << master.output();
  Program again("telekerf-master", secured(store, {}));
  EXPECT_EQ(again.wait(seconds(20)), 2) << again.output();
  EXPECT_NE(again.output().find("has expired on"), std::string::npos) << again.output();
}

}  // namespace
}  // namespace telekerf::integration
