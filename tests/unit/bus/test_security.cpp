// SPDX-License-Identifier: Apache-2.0
// Participants with keys: what they are told, what they let in, what it costs the control loop, and what the
// emulated network makes of prefixes that DDS Security has chosen.
#include <gtest/gtest.h>

#include <thread>

#include "common/bus/expiry.h"
#include "common/bus/security/keystore_check.h"
#include "common/bus/security/roles.h"
#include "common/bus/stop_line.h"
#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"
#include "netem/drivers/receive_path_emulator.h"
#include "tests/unit/allocations.h"
#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"
#include "tests/unit/security/store.h"

namespace telekerf {
namespace {

using security::Store;

const Store& keys() {
  static const Store store({"cell-1", "other"});
  return store;
}

BusSettings secured(const std::string& role, Site site = Site::kOperator, bool wan = false) {
  BusSettings made = settings(role, site);
  made.cell = "cell-1";
  made.security = keys().folder().string();
  made.wan = wan;
  return made;
}

bool sees(const Bus& bus, const std::string& role) {
  return soon([&] {
    for (const PresenceMessage& other : bus.others()) {
      if (other.role == role && other.joined) return true;
    }
    return false;
  });
}

class Secured : public ::testing::TestWithParam<bool> {};

TEST_P(Secured, BlocksContoursEventsAndPresenceCross) {
  Bus master(secured("master", Site::kOperator, this->GetParam()));
  Bus slave(secured("slave", Site::kSlave, this->GetParam()));
  Bus vision(secured("vision", Site::kSlave, this->GetParam()));
  EXPECT_TRUE(sees(master, "slave") && sees(master, "vision") && sees(slave, "master"));
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> heard(slave);
  Writer<StateBlock> states(slave);
  Reader<StateBlock> seen(master);
  Writer<ContourMessage> contours(vision);
  samples::Random random(1);
  const ContourMessage contour = samples::contour(random, 5000);
  ASSERT_TRUE(contours.write(contour));
  Reader<ContourMessage> late(master);
  Writer<EventMessage> events(master);
  Reader<EventMessage> told(slave);
  ASSERT_TRUE(soon([&] {
    return commands.readers() > 0 && heard.writers() > 0 && states.readers() > 0 && seen.writers() > 0;
  }));
  ASSERT_TRUE(events.wait_for_reader(kPatience));
  EXPECT_TRUE(events.write(event(7)));
  const auto one = take_soon(told);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->value.epoch, 7u);
  const auto whole = take_soon(late);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->value.points_m.size(), contour.points_m.size());
  for (std::uint32_t i = 1; i <= 200; ++i) {
    CommandBlock command = samples::command(random, 60);
    command.sequence = i;
    command.epoch = master.settings().epoch;
    ASSERT_TRUE(commands.write(command));
    const auto block = take_soon(heard);
    ASSERT_TRUE(block);
    EXPECT_EQ(block->value.sequence, i);
    StateBlock state = samples::state(random, 60);
    state.sequence = i;
    state.epoch = slave.settings().epoch;
    ASSERT_TRUE(states.write(state));
    ASSERT_TRUE(take_soon(seen));
  }
  EXPECT_EQ(heard.counters().strangers + heard.counters().damaged, 0u);
  EXPECT_EQ(master.counters().refused + slave.counters().refused, 0u);
}
INSTANTIATE_TEST_SUITE_P(Governance, Secured, ::testing::Bool(),
                         [](const auto& each) { return each.param ? "Encrypted" : "Signed"; });

TEST(Security, WhoHasNoKeysNeitherIsSeenNorSees) {
  Bus slave(secured("slave", Site::kSlave));
  BusSettings bare = settings("master");
  bare.cell = "cell-1";
  Bus liar(bare);  // announces itself as a joined master
  EXPECT_TRUE(soon([&] { return slave.counters().refused > 5; }));
  EXPECT_TRUE(slave.others().empty());
  EXPECT_TRUE(liar.others().empty());
  ASSERT_FALSE(slave.strangers().empty());
  EXPECT_NE(slave.strangers().front().find("without keys of cell 'cell-1'"), std::string::npos);
  EXPECT_NO_THROW(Bus(secured("master"))) << "who lies keeps nobody out";
}

TEST(Security, ASecondMasterWithTrueKeysIsRefused) {
  BusSettings first = secured("master"), second = secured("master");
  first.epoch = 1;
  second.epoch = 2;
  second.discovery_wait = kPatience;
  Bus master(first);
  EXPECT_THROW(Bus{second}, StartupError);
  EXPECT_TRUE(master.others().empty() || !master.rival());
}

TEST(Security, WhatARoleMayNotSayOrHearIsRefused) {
  Bus console(secured("console"));
  EXPECT_THROW(Writer<CommandBlock>{console}, StartupError);
  EXPECT_NO_THROW(Reader<StateBlock>{console});
  Bus vision(secured("vision", Site::kSlave));
  EXPECT_THROW(Writer<StopMessage>{vision}, StartupError);
  EXPECT_THROW(Reader<CommandBlock>{vision}, StartupError);
  Bus recorder(secured("recorder"));
  EXPECT_THROW(Writer<EventMessage>{recorder}, StartupError);
}

TEST(Security, KeysThatDoNotFitAreRefusedWithAReason) {
  const auto refusal = [](const BusSettings& with) {
    try {
      const Bus bus(with);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  BusSettings wrong = secured("master");
  wrong.cell = "nowhere";
  EXPECT_NE(refusal(wrong).find("nowhere/master/cert.pem is not there"), std::string::npos) << refusal(wrong);
  wrong = secured("master");
  wrong.domain = 231;
  EXPECT_NE(refusal(wrong).find("within [0, 230]"), std::string::npos) << refusal(wrong);
  wrong = secured("nobody");
  EXPECT_NE(refusal(wrong).find("no keys for a nobody"), std::string::npos) << refusal(wrong);
  const Store brief({"cell-1"}, std::chrono::seconds(30));
  security::renew_keystore(brief.folder(), {}, std::chrono::seconds(3));
  std::this_thread::sleep_until(*security::certificate_end(brief.role("master") / "cert.pem") - 300ms);
  wrong = secured("master");
  wrong.security = brief.folder().string();
  EXPECT_NE(refusal(wrong).find("too soon to begin anything"), std::string::npos) << refusal(wrong);
}

TEST(Security, AnAuthorityNearItsEndIsToldAsSuch) {
  const Store store({"cell-1"});
  store.end_authority("identity_ca", std::chrono::hours(24 * 10));
  BusSettings with = secured("master");
  with.security = store.folder().string();
  Bus master(with);
  const std::vector<std::string> told = master.dates();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told.front().starts_with("the authority identity_ca.pem ends on")) << told.front();
}

TEST(Security, ABlockCostsTheControlLoopNoHeap) {
  Bus master(secured("master"));
  Bus slave(secured("slave", Site::kSlave));
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> heard(slave);
  ASSERT_TRUE(soon([&] { return commands.readers() > 0 && heard.writers() > 0; }));
  CommandBlock block;
  block.payload.size = 60;
  const auto write = [&] {
    ++block.sequence;
    const std::uint64_t before = telekerf::testing::allocations_here();
    EXPECT_TRUE(commands.write(block));
    const std::uint64_t cost = telekerf::testing::allocations_here() - before;
    std::this_thread::sleep_for(2ms);
    return cost;
  };
  for (int i = 0; i < 100; ++i) (void)write();  // every slot has had its turn
  std::uint64_t allocated = 0;
  for (int i = 0; i < 200; ++i) allocated += write();
  EXPECT_EQ(allocated, 0u);
  EXPECT_GT(heard.counters().received, 150u);
}

TEST(Security, NoSampleIsYoungerThanItsDrawnDelay) {
  netem::Profile profile;
  profile.forward.stages[0].conditions.delay.delay_s = 0.030;
  profile.backward.stages[0].conditions.delay.delay_s = 0.012;
  const auto emulated = [&](BusSettings made, const std::shared_ptr<netem::ReceivePathEmulator>& emulator) {
    made.receive_filter = emulator;
    return made;
  };
  const auto into_slave = std::make_shared<netem::ReceivePathEmulator>(profile, 3, Site::kSlave);
  const auto into_master = std::make_shared<netem::ReceivePathEmulator>(profile, 3, Site::kOperator);
  Bus master(emulated(secured("master"), into_master));
  Bus slave(emulated(secured("slave", Site::kSlave), into_slave));
  Bus vision(secured("vision", Site::kSlave));
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> heard(slave);
  Writer<StateBlock> states(slave);
  Reader<StateBlock> seen(master);
  Writer<EventMessage> events(vision);  // the slave's own site
  Reader<EventMessage> near(slave);
  ASSERT_TRUE(soon([&] {
    return commands.readers() > 0 && heard.writers() > 0 && states.readers() > 0 && seen.writers() > 0;
  }));
  std::int64_t least_forward = 1'000'000'000, least_backward = least_forward, least_near = least_forward;
  for (std::uint32_t i = 1; i <= 50; ++i) {
    CommandBlock command;
    command.sequence = i;
    command.sent_ns = monotonic_ns();
    ASSERT_TRUE(commands.write(command));
    const auto there = take_soon(heard);
    ASSERT_TRUE(there);
    least_forward = std::min(least_forward, there->received_ns - there->value.sent_ns);
    StateBlock state;
    state.sequence = i;
    state.sent_ns = monotonic_ns();
    ASSERT_TRUE(states.write(state));
    const auto back = take_soon(seen);
    ASSERT_TRUE(back);
    least_backward = std::min(least_backward, back->received_ns - back->value.sent_ns);
  }
  EXPECT_GE(least_forward, 30'000'000);
  EXPECT_GE(least_backward, 12'000'000);
  EXPECT_LT(least_backward, 29'000'000) << "the other direction's delay";
  ASSERT_TRUE(events.wait_for_reader(kPatience));
  for (std::uint32_t i = 0; i < 20; ++i) {
    const std::int64_t sent_ns = monotonic_ns();
    ASSERT_TRUE(events.write(event(i)));
    const auto told = take_soon(near);
    ASSERT_TRUE(told);
    least_near = std::min(least_near, told->received_ns - sent_ns);
  }
  EXPECT_LT(least_near, 10'000'000) << "vision stands at the slave's site";
  EXPECT_GE(into_slave->counters().earliest_ns, 0);
  EXPECT_GT(into_slave->counters().emulated, 50u);
}

TEST(Expiry, IsToldOfThirtyDaysAndADayBeforeAndAtTheEnd) {
  using std::chrono::hours;
  const security::Time end = security::Time() + hours(24 * 400);
  bus::Expiry expiry({{"the identity of this master", end, true, true},
                      {"the identity of console", end + hours(2), false, false}});
  EXPECT_TRUE(expiry.due(end - hours(24 * 31)).empty());
  const auto month = expiry.due(end - hours(24 * 30 - 2));
  ASSERT_EQ(month.size(), 2u);
  EXPECT_NE(month.front().find("the identity of this master ends on 1971-02-05 00:00 UTC, in 29 days"),
            std::string::npos)
      << month.front();
  EXPECT_TRUE(expiry.due(end - hours(24 * 20)).empty()) << "said once";
  EXPECT_EQ(expiry.due(end - hours(23)).size(), 1u);
  EXPECT_FALSE(expiry.lets_go(end - std::chrono::seconds(4)));
  EXPECT_TRUE(expiry.lets_go(end - std::chrono::seconds(2)));
  EXPECT_TRUE(expiry.ended(end - std::chrono::seconds(1)).empty());
  EXPECT_FALSE(expiry.ended(end).empty());
  EXPECT_EQ(expiry.due(end).size(), 2u) << "the end of one, the last day of the other";
}

TEST(Expiry, AWorkThatWouldOutliveItsKeysIsNotBegun) {
  using std::chrono::hours;
  using std::chrono::minutes;
  const security::Validity year{security::Time(), security::Time() + hours(24 * 365), ""};
  EXPECT_FALSE(bus::ends_too_soon(year, year.end - minutes(61)));
  EXPECT_TRUE(bus::ends_too_soon(year, year.end - minutes(59)));
  const security::Validity brief{security::Time(), security::Time() + minutes(10), ""};
  EXPECT_FALSE(bus::ends_too_soon(brief, brief.end - minutes(2)));
  EXPECT_TRUE(bus::ends_too_soon(brief, brief.end - std::chrono::seconds(59)));
}

TEST(StopLineWithKeys, HearsOnAfterAThousandStops) {
  Bus slave(secured("slave", Site::kSlave));
  Bus ctl(secured("ctl"));
  StopLine line(slave, "");
  Writer<StopMessage> says(ctl);
  ASSERT_TRUE(says.wait_for_reader(10s));
  StopMessage stop{.epoch = ctl.settings().epoch,
                   .number = 1,
                   .source = "ann",
                   .set = true,
                   .obeyed = false,
                   .reason = ""};
  for (int n = 0; n < 1000; ++n) {
    stop.number = 1 + static_cast<std::uint32_t>(n) / 2;
    stop.set = n % 2 == 0;
    line.obeyed(stop.set ? stop.number : 0);
    says.write(stop);
    if (n % 10 == 0) std::this_thread::sleep_for(1ms);
  }
  stop.number = 600;
  stop.set = true;
  EXPECT_TRUE(soon([&] {
    says.write(stop);
    return line.order().number == 600;
  })) << "it neither hears nor answers any more";
}

}  // namespace
}  // namespace telekerf
