// SPDX-License-Identifier: Apache-2.0
// A cell with keys and one without: what each says at its start, what it refuses, and how a work ends with
// its keys.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/bus/security/keystore.h"
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
  for (const Program* const each : {&slave, &master}) {
    EXPECT_TRUE(
        each->says("and does not prove it: both sides need keys of the same ./telekerf keys", seconds(60)))
        << each->output();
    EXPECT_EQ(each->output().find("an unknown address"), std::string::npos) << each->output();
  }
}

TEST_F(SecuredCell, WhoSpeaksAnotherProtectionIsToldWhichOneTheCellHas) {
  const Store store;
  const auto refused = [&](std::vector<std::string> words, const std::string& why) {
    words.insert(words.end(), {"--domain", own_domain()});
    Program ctl("telekerf-ctl", words);
    EXPECT_EQ(ctl.wait(seconds(30)), words.front() == "look" ? 1 : 2) << ctl.output();
    EXPECT_NE(ctl.output().find(why), std::string::npos) << ctl.output();
  };
  const std::string keys = store.folder().string();
  {
    Program slave("telekerf-slave", secured(store, {"--wan"}));
    ASSERT_TRUE(slave.says("ready in", seconds(20))) << slave.output();
    refused({"stop", "--security", keys}, "messages of slave of cell 'cell-1' are encrypted");
    refused({"stop", "--security", keys}, "give this process --wan, too");
    refused({"look", "--security", keys, "--wait-s", "5"},
            "messages of slave of cell 'cell-1' are encrypted");
    refused({"engage", "--security", keys}, "messages of slave of cell 'cell-1' are encrypted");
    refused({"stop", "--insecure"},
            "with keys cannot be heard without: if this cell has some, give --security DIR");
  }
  Program slave("telekerf-slave", secured(store, {}));
  ASSERT_TRUE(slave.says("ready in", seconds(20))) << slave.output();
  refused({"stop", "--security", keys, "--wan"},
          "messages of slave of cell 'cell-1' are signed and not encrypted");
  EXPECT_TRUE(slave.says("messages of ctl of cell 'cell-1' are encrypted", seconds(5))) << slave.output();
  Program stop("telekerf-ctl", secured(store, {"stop"}));
  EXPECT_EQ(stop.wait(seconds(20)), 0) << stop.output();
  EXPECT_EQ(stop.output().find("not secured"), std::string::npos) << stop.output();
}

TEST_F(SecuredCell, WithoutKeysTheStartSaysSoAndOtherComputersAreNotReached) {
  if (everyone_has_keys()) GTEST_SKIP() << "is about cells without keys";
  Program slave("telekerf-slave", {"--domain", own_domain(), "--cell", "bare"});
  ASSERT_TRUE(slave.says("slave: not secured", seconds(20))) << slave.output();
  Program ctl("telekerf-ctl", {"stop", "--domain", own_domain(), "--cell", "bare"});
  EXPECT_EQ(ctl.wait(seconds(20)), 0) << ctl.output();
  EXPECT_TRUE(ctl.says("ctl: not secured", seconds(1))) << ctl.output();
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

TEST_F(SecuredCell, WhatComesInADevicesPlaceIsRefusedInWordsAndCounted) {
  using boost::asio::ip::udp;
  const Store store;
  boost::asio::io_context context;
  udp::socket stranger(context, {boost::asio::ip::address_v4::loopback(), 0});
  const std::string out = (Program::scratch() / "pedal").string();
  const auto pedal = udp::socket(context, {boost::asio::ip::address_v4::loopback(), 0}).local_endpoint();
  Program master("telekerf-master",
                 secured(store, {"--record", out, "--button",
                                 fmt::format("udp:127.0.0.1:{},key={}", pedal.port(),
                                             security::device_key_file(store.folder(), "cell-1").string())}));
  ASSERT_TRUE(master.says("ready in", seconds(20))) << master.output();
  stranger.send_to(boost::asio::buffer(std::string(24, 'x')), pedal);
  EXPECT_TRUE(master.says("button: refused 1 datagram so far", seconds(10))) << master.output();
  for (int n = 0; n < 9; ++n) stranger.send_to(boost::asio::buffer(std::string(41, 'x')), pedal);
  EXPECT_TRUE(master.says("button: refused 10 datagrams so far", seconds(10))) << master.output();
  master.interrupt();
  EXPECT_EQ(master.wait(seconds(20)), 0) << master.output();
  EXPECT_EQ(master.output().find("drive: refused"), std::string::npos) << master.output();
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
