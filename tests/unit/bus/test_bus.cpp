// SPDX-License-Identifier: Apache-2.0
// Several participants in one process on loopback. A domain and a cell of this process' own keep tests that
// run side by side apart.
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>

#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"
#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"

namespace telekerf {
namespace {

using testing::HasSubstr;

TEST(Bus, StreamsCrossBothWays) {
  Bus master(settings("master"));
  Bus slave(settings("slave", Site::kSlave));
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> commands_read(slave);
  Writer<StateBlock> states(slave);
  Reader<StateBlock> states_read(master);
  ASSERT_TRUE(commands.wait_for_reader(kPatience));
  ASSERT_TRUE(states.wait_for_reader(kPatience));
  ASSERT_TRUE(soon([&] { return commands_read.writers() == 1 && states_read.writers() == 1; }));

  samples::Random random(1);
  for (std::size_t bytes = 0; bytes < 2000; bytes += 100) {
    CommandBlock command = samples::command(random, bytes);
    command.epoch = master.settings().epoch;
    const std::int64_t before_ns = monotonic_ns();
    ASSERT_TRUE(commands.write(command));
    const auto command_back = take_soon(commands_read);
    ASSERT_TRUE(command_back);
    EXPECT_TRUE(samples::same(command, command_back->value));
    EXPECT_GT(command_back->received_ns, before_ns);
    EXPECT_LE(command_back->received_ns, monotonic_ns());

    StateBlock state = samples::state(random, bytes);
    state.epoch = slave.settings().epoch;
    ASSERT_TRUE(states.write(state));
    const auto state_back = take_soon(states_read);
    ASSERT_TRUE(state_back);
    EXPECT_TRUE(samples::same(state, state_back->value));
  }
  EXPECT_EQ(commands_read.counters().received, 20u);
  EXPECT_EQ(commands_read.counters().damaged, 0u);
}

TEST(Bus, OnlyWhoHasAnnouncedItselfInTheRoleIsHeardAndOthersAreNamed) {
  auto ours = settings("master");
  ours.epoch = 5;
  Bus master(ours);
  Bus console(settings("console"));
  Bus slave(settings("slave", Site::kSlave));
  Writer<CommandBlock> commands(master);
  Writer<CommandBlock> forged(console);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(commands.wait_for_reader(kPatience));
  ASSERT_TRUE(forged.wait_for_reader(kPatience));
  ASSERT_TRUE(soon([&] { return reader.writers() == 2; }));
  samples::Random random(3);
  CommandBlock block = samples::command(random, 60);
  block.epoch = 5;
  ASSERT_TRUE(forged.write(block));
  EXPECT_TRUE(soon([&] { return reader.counters().strangers == 1; }));
  block.epoch = 6;  // of another start than the one that announces itself
  ASSERT_TRUE(commands.write(block));
  EXPECT_TRUE(soon([&] { return reader.counters().strangers == 2; }));
  block.epoch = 5;
  ASSERT_TRUE(commands.write(block));
  EXPECT_TRUE(take_soon(reader));
  EXPECT_EQ(reader.counters().received, 1u);
  EXPECT_EQ(slave.counters().strangers, 2u);
  const auto named = slave.strangers();
  EXPECT_THAT(named, testing::Contains(testing::AllOf(HasSubstr("console 'console' ("),
                                                      HasSubstr("telekerf/command is not heard"))));
}

TEST(Bus, ALatecomerGetsALargeContour) {
  Bus vision(settings("vision", Site::kSlave));
  Writer<ContourMessage> contours(vision);
  samples::Random random(2);
  ASSERT_TRUE(contours.write(samples::contour(random, 10)));
  const ContourMessage newest = samples::contour(random, 100000);
  ASSERT_TRUE(contours.write(newest));

  Bus master(settings("master"));
  Reader<ContourMessage> reader(master);
  const auto contour = take_soon(reader);
  ASSERT_TRUE(contour);
  EXPECT_TRUE(samples::same(newest, contour->value));
}

TEST(Bus, EventsAreAllDeliveredAndOwnOnesUnseen) {
  Bus console(settings("console"));
  Bus slave(settings("slave", Site::kSlave));
  Writer<EventMessage> events(console);
  Reader<EventMessage> own(console);
  Reader<EventMessage> reader(slave);
  ASSERT_TRUE(events.wait_for_reader(kPatience, 2));
  for (std::uint32_t i = 0; i < 100; ++i) {
    ASSERT_TRUE(
        events.write({.epoch = i, .kind = EventMessage::Kind::kFinished, .value = 0.5, .text = "done"}));
  }
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto taken = take_soon(reader);
    ASSERT_TRUE(taken) << i;
    EXPECT_EQ(taken->value.epoch, i);
    EXPECT_EQ(taken->value.kind, EventMessage::Kind::kFinished);
    EXPECT_EQ(taken->value.text, "done");
  }
  EXPECT_FALSE(own.take());
}

TEST(Bus, TelemetryCrosses) {
  Bus slave(settings("slave", Site::kSlave));
  Bus console(settings("console"));
  Writer<TelemetryMessage> writer(slave);
  Reader<TelemetryMessage> reader(console);
  ASSERT_TRUE(writer.wait_for_reader(kPatience));
  ASSERT_TRUE(soon([&] { return reader.writers() == 1; }));
  const TelemetryMessage message{.role = "slave", .tick = 5, .values = {{"a", 1.0}, {"b", -2.5}}};
  ASSERT_TRUE(writer.write(message));
  const auto back = take_soon(reader);
  ASSERT_TRUE(back);
  EXPECT_TRUE(samples::same(message, back->value));
}

TEST(Bus, CellsDoNotHearEachOther) {
  Bus master(settings("master"));
  auto elsewhere = settings("master");
  elsewhere.cell += "-other";
  Bus stranger(elsewhere);  // the same role and name: no refusal across cells
  Bus slave(settings("slave", Site::kSlave));
  Writer<EventMessage> ours(master);
  Writer<EventMessage> theirs(stranger);
  Reader<EventMessage> reader(slave);
  ASSERT_TRUE(ours.wait_for_reader(kPatience));
  ASSERT_TRUE(theirs.write(event(1)));
  ASSERT_TRUE(ours.write(event(2)));
  const auto taken = take_soon(reader);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->value.epoch, 2u);
  EXPECT_EQ(theirs.readers(), 0);
  EXPECT_EQ(reader.writers(), 1);
  EXPECT_TRUE(stranger.others().empty());
}

TEST(Bus, AFullReaderDropsTheNewestAndCounts) {
  Bus master(settings("master"));
  Bus slave(settings("slave", Site::kSlave));
  Writer<EventMessage> events(master);
  Reader<EventMessage> reader(slave, 4);
  ASSERT_TRUE(events.wait_for_reader(kPatience));
  for (std::uint32_t i = 0; i < 10; ++i) ASSERT_TRUE(events.write(event(i)));
  ASSERT_TRUE(soon([&] { return reader.counters().received == 10; }));
  EXPECT_EQ(reader.counters().dropped, 6u);
  EXPECT_EQ(reader.take()->value.epoch, 0u);
}

TEST(Bus, ASecondMasterIsRefusedAndTheFirstCarriesOn) {
  Bus first(settings("master"));
  auto second = settings("master");
  second.name = "spare";
  second.discovery_wait = kPatience;  // refused as soon as it sees the first
  try {
    Bus bus(second);
    FAIL() << "two masters";
  } catch (const StartupError& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("a second master in cell"));
    EXPECT_THAT(refusal.what(), HasSubstr("'master' already runs"));
  }
  EXPECT_EQ(first.counters().incompatible, 1u);
}

TEST(Bus, ADuplicateNameIsRefused) {
  Bus first(settings("console"));
  auto second = settings("recorder");
  second.name = "console";
  second.discovery_wait = kPatience;
  EXPECT_THROW(Bus bus(second), StartupError);
}

TEST(Bus, AnotherContractIsRefused) {
  Bus slave(settings("slave", Site::kSlave));
  auto newer = settings("master");
  newer.contract = kContractVersion + 1;
  newer.discovery_wait = kPatience;
  try {
    Bus bus(newer);
    FAIL() << "two contracts";
  } catch (const StartupError& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("install the same version"));
  }
}

TEST(Bus, OfTwoMastersThatStartTogetherTheLowerEpochStays) {
  const auto start = [](std::uint32_t epoch) {
    auto master = settings("master");
    master.name = "master-" + std::to_string(epoch);
    master.epoch = epoch;
    master.discovery_wait = 1500ms;
    return std::make_unique<Bus>(master);
  };
  auto higher = std::async(std::launch::async, start, 8);
  auto lower = std::async(std::launch::async, start, 7);
  EXPECT_THROW(higher.get(), StartupError);
  EXPECT_NO_THROW(lower.get());
}

TEST(Bus, WaitsForARole) {
  Bus master(settings("master"));
  EXPECT_FALSE(master.wait_for_role("slave", 50ms));
  auto slave = std::make_unique<Bus>(settings("slave", Site::kSlave));
  EXPECT_TRUE(master.wait_for_role("slave", kPatience));
  ASSERT_EQ(master.others().size(), 1u);
  EXPECT_EQ(master.others()[0].version, kVersion);
  slave.reset();
  EXPECT_TRUE(soon([&] { return master.others().empty(); }));
}

TEST(Bus, RefusesADomainWhoseDiscoveryPortAnotherProgramHasForItself) {
  const BusSettings ours = settings("master");
  const int port = 7400 + 250 * ours.domain;
  const int other = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  ASSERT_EQ(::bind(other, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  std::string refusal;
  try {
    const Bus bus(ours);
  } catch (const StartupError& error) {
    refusal = error.what();
  }
  ::close(other);
  EXPECT_THAT(refusal, HasSubstr("UDP port " + std::to_string(port) + " of domain " +
                                 std::to_string(ours.domain) + ", where processes hear of each other"));
  const Bus one(ours);
  EXPECT_NO_THROW(const Bus two(settings("slave", Site::kSlave))) << "among our own processes the port is shared";
}

TEST(Bus, RefusesSettingsWithASentence) {
  const auto refusal = [](const BusSettings& wrong) -> std::string {
    try {
      const Bus bus(wrong);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  auto domain = settings("master");
  for (const int beyond : {-1, 233}) {
    domain.domain = beyond;
    EXPECT_EQ(refusal(domain), "domain " + std::to_string(beyond) + " is outside [0, 232]");
  }
  auto cell = settings("master");
  for (const char* pattern : {"a*", "a?", "a[", "a]"}) {
    cell.cell = pattern;
    EXPECT_THAT(refusal(cell), HasSubstr("must hold none of * ? [ ]")) << pattern;
  }
  cell.cell.clear();
  EXPECT_THAT(refusal(cell), HasSubstr("a cell needs a name"));
  auto name = settings("master");
  name.name.assign(65, 'n');
  EXPECT_THAT(refusal(name), HasSubstr("64, 32 and 64 letters"));
  auto peer = settings("master");
  peer.peers = {"no-such-host.invalid"};
  EXPECT_THROW(Bus bus(peer), StartupError);
  auto port = settings("master");
  for (const char* wrong : {"127.0.0.1:65536", "127.0.0.1:0", "127.0.0.1:x"}) {
    port.peers = {wrong};
    EXPECT_THAT(refusal(port), HasSubstr("must be HOST or HOST:PORT")) << wrong;
  }
  port.peers = {"127.0.0.1:65535"};
  EXPECT_EQ(refusal(port), "");
}

TEST(Bus, NamedPeersAreAddedToMulticast) {
  auto with_peer = settings("master");
  with_peer.peers = {"127.0.0.1"};
  Bus master(with_peer);
  Bus slave(settings("slave", Site::kSlave));
  EXPECT_TRUE(master.wait_for_role("slave", kPatience));
  EXPECT_TRUE(slave.wait_for_role("master", kPatience));
}

TEST(Bus, EndpointsMayOutliveTheBus) {
  auto bus = std::make_unique<Bus>(settings("slave", Site::kSlave));
  Writer<StateBlock> writer(*bus);
  Reader<CommandBlock> reader(*bus);
  bus.reset();
  EXPECT_TRUE(writer.write({}));
  EXPECT_FALSE(reader.take());
}

}  // namespace
}  // namespace telekerf
