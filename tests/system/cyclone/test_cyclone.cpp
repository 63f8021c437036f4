// SPDX-License-Identifier: Apache-2.0
// Cyclone DDS reads our latched contour and our stream, and we read its event.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <future>
#include <string>

#include "common/bus/middleware.h"
#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"
#include "tests/unit/security/store.h"

namespace telekerf {
namespace {

/// What the peer prints, line by line.
std::string run_peer(const BusSettings& settings, const std::string& role = "") {
  const std::string command = fmt::format("{} {} {} {} {}", TELEKERF_CYCLONE_PEER, settings.domain,
                                          settings.cell, settings.contract, role);
  std::string printed;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 1024> line{};
  while (fgets(line.data(), line.size(), pipe) != nullptr) printed += line.data();
  EXPECT_EQ(pclose(pipe), 0);
  return printed;
}

TEST(Cyclone, AForeignPeerReadsAndWritesTheContract) {
  samples::Random random(1);
  const ContourMessage contour = samples::contour(random, 3000);
  StateBlock state = samples::state(random, 60);
  state.sequence = 0;  // a block that carries its set, whatever its payload says of samples
  double sum = 0.0;
  for (const Vec2& point : contour.points_m) sum += point.x() - 2.0 * point.y();
  unsigned octets = 0;
  for (const std::uint8_t byte : state.payload.view()) octets = octets * 31u + byte;

  Bus slave(settings("slave", Site::kSlave));
  Writer<ContourMessage> contours(slave);
  Writer<StateBlock> states(slave);
  Reader<EventMessage> events(slave);
  ASSERT_TRUE(contours.write(contour));  // before the peer is there

  auto printed = std::async(std::launch::async, [&] { return run_peer(slave.settings()); });
  while (printed.wait_for(10ms) != std::future_status::ready) ASSERT_TRUE(states.write(state));
  EXPECT_EQ(printed.get(),
            fmt::format("contour {} {} {} leaf.png outline 3000 {:.17g}\n", kContractVersion, contour.id,
                        contour.closed ? 1 : 0, sum) +
                fmt::format("state {} {} {:.9g} {:.9g} {} {} 60 {}\n", state.sequence, state.applied_bitmap,
                            state.anchor.position_m.z(), state.anchor.velocity_m_per_s.x(),
                            static_cast<int>(state.interlock), state.echo_received_ns, octets));
  const auto event = take_soon(events);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->value.epoch, 7u);
  EXPECT_EQ(event->value.kind, EventMessage::Kind::kSetBeta);
  EXPECT_EQ(event->value.value, 0.5);
  EXPECT_EQ(event->value.text, "from elsewhere");
}

/// What a slave makes of what the peer says in this role while a master of ours is there.
ReaderCounters heard_beside_a_master(const std::string& role) {
  Bus master(settings("master"));
  Bus slave(settings("slave", Site::kSlave));  // the second of its host
  Reader<CommandBlock> commands(slave);
  Writer<CommandBlock> own(master);
  EXPECT_TRUE(own.wait_for_reader(kPatience));
  EXPECT_TRUE(soon([&] { return commands.writers() == 1; }));
  (void)run_peer(slave.settings(), role);
  return commands.counters();
}

TEST(Cyclone, AForeignMasterThatComesLateIsHeardAndWhoIsNoneIsNot) {
  const ReaderCounters master = heard_beside_a_master("master");
  EXPECT_GT(master.damaged, 20u) << "of 100 blocks";
  EXPECT_EQ(master.strangers, 0u);
  for (const std::string other : {"vision", "-"}) {
    const ReaderCounters stranger = heard_beside_a_master(other);
    EXPECT_GT(stranger.strangers, 20u) << other;
    EXPECT_EQ(stranger.damaged, 0u) << other;
  }
}

TEST(Cyclone, APeerWithKeysReadsAndIsRefusedAsACommander) {
  if (!std::filesystem::exists(TELEKERF_CYCLONE_PLUGINS "/libdds_security_auth.so"))
    GTEST_SKIP() << "Cyclone DDS has no security plugins here";
#ifdef TELEKERF_FASTDDS_3
  GTEST_SKIP() << "Cyclone DDS 0.10.5 and Fast DDS 3.1 prove to each other who they are, and then do not exchange the "
                  "keys of their discovery";
#endif
  const security::Store store;
  const auto secured = [&](const std::string& role) {
    BusSettings made = settings(role, Site::kSlave);
    made.cell = "cell-1";
    made.security = store.folder().string();
    return made;
  };
  samples::Random random(1);
  const ContourMessage contour = samples::contour(random, 3000);
  StateBlock state = samples::state(random, 60);
  state.sequence = 0;
  Bus vision(secured("vision"));
  Bus slave(secured("slave"));
  Writer<ContourMessage> contours(vision);
  Writer<StateBlock> states(slave);
  ASSERT_TRUE(contours.write(contour));
  auto printed = std::async(std::launch::async,
                            [&] { return run_peer(slave.settings(), "keys " + store.folder().string()); });
  while (printed.wait_for(10ms) != std::future_status::ready) ASSERT_TRUE(states.write(state));
  const std::string said = printed.get();
  EXPECT_NE(said.find(fmt::format("contour {} {} ", kContractVersion, contour.id)), std::string::npos) << said;
  EXPECT_NE(said.find(fmt::format("state {} ", state.sequence)), std::string::npos) << said;
  EXPECT_NE(said.find("commands: refused"), std::string::npos) << said;
}

}  // namespace
}  // namespace telekerf
