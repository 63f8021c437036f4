// SPDX-License-Identifier: Apache-2.0
// Blocks that no master sends, at random: whatever stands in them the slave keeps its numbers finite and
// lights nothing outside, and when they are over it hears its master again.
#include "tests/unit/hostile_values.h"
#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

constexpr std::int64_t kLeast = HostileValues::kLeast;
constexpr std::int64_t kLargest = HostileValues::kLargest;

class HostileCommands : public SlaveNodeTest, public testing::WithParamInterface<std::uint64_t> {
 protected:
  /// A true block with some of it changed.
  CommandBlock changed(CommandBlock block) {
    const auto again = [&](auto change) {
      if (random_.one_in(6)) change();
    };
    again([&] {
      block.sequence = random_.some<std::uint32_t>({0, 1, block.sequence + 60, 0x7FFFFFFF, 0xFFFFFFFF});
    });
    again([&] { block.epoch = random_.some<std::uint32_t>({0, epoch_ + 1, 0xFFFFFFFF}); });
    again([&] {
      block.first_tick = random_.some<Tick>({0, block.first_tick + 900, Tick{1} << 62U, ~Tick{0}});
    });
    again([&] {
      block.sample_period_ns = random_.some<std::uint32_t>({0, 1, 10'000, 100'000'000, 0xFFFFFFFF});
    });
    again([&] { block.ticks_per_sample = random_.some<std::uint16_t>({0, 1, 2, 1000, 0xFFFF}); });
    again([&] { block.contour_id = random_.some<std::uint32_t>({0, 1, 2}); });
    again([&] { block.beta = random_.some_number(); });
    again([&] { block.engaged = !block.engaged; });
    again([&] { block.engaged_before = static_cast<std::uint8_t>(random_()); });
    again([&] { block.anchor.position_m[static_cast<int>(random_() % 3)] = random_.some_number(); });
    again([&] { block.anchor.velocity_m_per_s[static_cast<int>(random_() % 3)] = random_.some_number(); });
    again([&] { block.sent_ns = random_.some<std::int64_t>({kLeast, -1, 0, now_ns_, kLargest}); });
    again([&] { block.engage = random_.some<std::uint32_t>({0, engage_ + 1, 0x7FFFFFFF, 0xFFFFFFFF}); });
    again([&] { block.echo_sequence = random_.some<std::uint32_t>({0, echo_.sequence + 1, 0xFFFFFFFF}); });
    again([&] { block.echo_sent_ns = random_.some<std::int64_t>({kLeast, -1, 0, now_ns_ + 1, kLargest}); });
    again([&] { block.payload.size = static_cast<std::uint16_t>(random_() % (Payload::kCapacity + 1)); });
    for (std::uint64_t flips = random_() % 4; flips > 0 && block.payload.size > 0; --flips)
      block.payload.bytes[random_() % block.payload.size] ^= static_cast<std::uint8_t>(1U << random_() % 8);
    return block;
  }
  /// A step in which all of `blocks` arrive at odd times.
  void hear(const std::vector<CommandBlock>& blocks) {
    std::vector<Received<CommandBlock>> arrived;
    for (const CommandBlock& block : blocks)
      arrived.push_back({block, now_ns_ - static_cast<std::int64_t>(random_() % kMs)});
    out_ = station_.step(now_ns_, corridor_.get(), arrived);
    if (out_.state) echo_ = *out_.state;
    now_ns_ += kMs;
    judge();
    ASSERT_TRUE(out_.currents_a.allFinite() && out_.reference.position_m.allFinite() &&
                out_.reference.velocity_m_per_s.allFinite() && std::isfinite(out_.laser_w));
    ASSERT_LE(out_.reference.position_m.head<2>().norm(), model_.workspace.radius_m + 1e-12);
    ASSERT_TRUE(out_.laser_w == 0.0 || out_.tool_m.head<2>().norm() <= model_.workspace.radius_m);
    ASSERT_TRUE(out_.command_age_s >= 0.0 || out_.command_age_s == -1.0) << out_.command_age_s;
    ASSERT_FALSE(out_.laser_w > 0.0 && station_.machine().failed());
  }

  HostileValues random_{GetParam()};
  robot::RobotModel model_ = robot::load_robot(StationSettings{}.robot);
};

TEST_P(HostileCommands, BreakNothingAndTheMasterIsHeardAgain) {
  follow(1.0);
  for (int b = 0; b < 120; ++b) {
    const CommandBlock good = next_block();
    for (int n = 0; n < 16; ++n) {
      std::vector<CommandBlock> blocks;
      if (n == 0 && b % 3 != 0) blocks.push_back(good);
      for (std::uint64_t more = random_() % 3; more > 0; --more) blocks.push_back(changed(good));
      hear(blocks);
      if (HasFatalFailure()) return;
      ASSERT_FALSE(station_.machine().failed()) << station_.machine().failure();
    }
  }
  // Whoever followed a forger hears its master again after a second of nothing acceptable, and needs one
  // engagement.
  for (int b = 0; b < 140; ++b) run(next_block());
  engage_ = echo_.engage + 1;
  released_blocks_ = 8;
  laser_ticks_ = 0;
  follow(1.5);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing) << static_cast<int>(out_.reason);
  // Nothing is lit that is not newer than all that was, be that forged and from the future.
  const bool was_lit_later = out_.forbidden == laser::guard_bit("unlit");
  EXPECT_TRUE(laser_ticks_ > 200 || was_lit_later) << std::hex << out_.forbidden << " forbids";
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileCommands, testing::Range<std::uint64_t>(1, 41));

}  // namespace
}  // namespace telekerf::slave
