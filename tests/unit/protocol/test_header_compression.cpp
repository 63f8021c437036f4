// SPDX-License-Identifier: Apache-2.0
// Blocks whose heads were compressed: restored to the bit whatever is lost on the way, or refused; never
// another block.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "common/protocol/header_compression.h"
#include "tests/unit/bus/samples.h"

namespace telekerf {
namespace {

constexpr std::uint16_t kContract = 6;
constexpr SenderKey kMaster{1}, kStranger{2};
constexpr std::int64_t kBlock_ns = 16'000'000;

/// Block n of a master whose hand moves on.
CommandBlock command(std::uint32_t n) {
  samples::Random random(n);
  CommandBlock block;
  block.sequence = n;
  block.epoch = 77;
  block.first_tick = 1'000'000 + 16 * std::uint64_t{n};
  block.sample_period_ns = 1'000'000;
  block.contour_id = 5;
  block.beta = 0.5;
  block.law = Law::kAnchored;
  block.engaged = true;
  block.engaged_before = 127;
  block.engage = 3;
  const double t = 0.016 * n;
  block.anchor.position_m = {0.03 * std::sin(t), 0.03 * std::cos(t), 1e-4};
  block.anchor.velocity_m_per_s = {0.03 * std::cos(t), -0.03 * std::sin(t), 0.0};
  block.anchor = to_wire_precision(block.anchor);
  block.sent_ns = n * kBlock_ns + static_cast<std::int64_t>(random() % 900) * 1000;
  block.echo_sequence = n / 2 * 2;
  block.echo_sent_ns = 5'000'000'000'000 + block.echo_sequence * kBlock_ns;
  samples::fill(random, block.payload, 30 + n % 5);
  const std::array<std::uint8_t, 10> prefix{0x30,
                                            0x21,
                                            0x3c,
                                            0xb1,
                                            0,
                                            0x0f,
                                            0x42,
                                            0x40,
                                            static_cast<std::uint8_t>((n + 9) >> 8),
                                            static_cast<std::uint8_t>(n + 9)};
  std::copy(prefix.begin(), prefix.end(), block.payload.bytes.begin());
  return block;
}
/// Of a hand that is quick, and of clocks that stand still now and then: most of it cannot be told near.
CommandBlock quick_command(std::uint32_t n) {
  CommandBlock block = command(n);
  const double t = 0.016 * n;
  block.anchor.position_m = {0.03 * std::sin(8.0 * t), 0.03 * std::cos(8.0 * t), 1e-4};
  block.anchor.velocity_m_per_s = {0.24 * std::cos(8.0 * t), -0.24 * std::sin(8.0 * t), 0.0};
  block.anchor = to_wire_precision(block.anchor);
  block.sent_ns += n / 50 * 200'000'000LL;
  block.echo_sent_ns += n / 70 * 10'000'000'000LL;
  return block;
}
StateBlock state(std::uint32_t n) {
  samples::Random random(n);
  const CommandBlock like = command(n);
  StateBlock block;
  block.sequence = n;
  block.epoch = 78;
  block.master_epoch = 77;
  block.first_tick = 2'000'000 + 16 * std::uint64_t{n};
  block.sample_period_ns = 1'000'000;
  block.contour_id = 5;
  block.beta = 0.5;
  block.anchor = like.anchor;
  block.interlock = Interlock::kReady;
  block.laser_on = true;
  block.applied_tick = block.first_tick - 100;
  block.applied_bitmap = n % 9 == 0 ? random() : ~std::uint64_t{0};
  block.applied_age_ticks = n % 3;
  block.playout_ticks = 17;
  block.echo_sequence = n;
  block.echo_sent_ns = 9'000'000'000 + n * kBlock_ns;
  block.sent_ns = like.sent_ns;
  block.echo_received_ns = block.sent_ns - 7'654'000;
  block.mode = SlaveMode::kFollowing;
  block.reason = HoldReason::kNone;
  block.engage = 2;
  block.command_age_s = 0.1339;
  block.payload = like.payload;
  block.force = command(n + 1).payload;
  block.force.bytes[9] = static_cast<std::uint8_t>(n + 9);
  block.force.bytes[8] = static_cast<std::uint8_t>((n + 9) >> 8);
  return block;
}

template <class Block>
struct Wire {
  HeaderCompressor<Block> sender;
  HeaderDecompressor<Block> receiver;
  std::array<std::uint8_t, kMaxStateBytes> room{};

  std::vector<std::uint8_t> sent(const Block& block) {
    const auto bytes = sender.compress(block, kContract, room);
    return {bytes.begin(), bytes.end()};
  }
  Verdict got(const std::vector<std::uint8_t>& bytes, Block& back, const SenderKey& from = kMaster) {
    return receiver.restore(bytes, from, kContract, back);
  }
};

template <class Block, class Make>
void expect_whatever_is_lost(const Make& make) {
  samples::Random random(1);
  Wire<Block> wire;
  std::uint32_t n = 0;
  for (int round = 0; round < 400; ++round) {
    const int lost = n == 0 ? 0 : static_cast<int>(random() % kWindow);
    for (int i = 0; i < lost; ++i) (void)wire.sent(make(n++));
    for (int come = 1 + static_cast<int>(random() % 5); come > 0; --come, ++n) {
      const Block block = make(n);
      Block back;
      ASSERT_EQ(wire.got(wire.sent(block), back), Verdict::kGood) << n;
      ASSERT_TRUE(samples::same(block, back)) << n;
    }
  }
}

TEST(HeaderCompression, BurstsOfLossesLeaveNothingBehind) {
  expect_whatever_is_lost<CommandBlock>(command);
  expect_whatever_is_lost<CommandBlock>(quick_command);
  expect_whatever_is_lost<StateBlock>(state);
}

TEST(HeaderCompression, OvertakenAndRepeatedBlocksComeBackToo) {
  Wire<CommandBlock> wire;
  std::vector<std::vector<std::uint8_t>> sent;
  for (std::uint32_t n = 0; n < 200; ++n) sent.push_back(wire.sent(command(n)));
  CommandBlock back;
  for (std::uint32_t n = 0; n < 196; n += 4) {
    for (const std::uint32_t m : {n + 1, n + 3, n, n + 2, n + 2}) {
      ASSERT_EQ(wire.got(sent[m], back), Verdict::kGood) << m;
      ASSERT_TRUE(samples::same(back, command(m))) << m;
    }
  }
}

TEST(HeaderCompression, AfterALongGapTheNextFarBlockIsRestored) {
  Wire<CommandBlock> wire;
  CommandBlock back;
  for (std::uint32_t n = 0; n < 65; ++n) (void)wire.got(wire.sent(command(n)), back);
  for (std::uint32_t n = 65; n < 90; ++n) (void)wire.sent(command(n));
  int refused = 0;
  std::uint32_t n = 90;
  while (wire.got(wire.sent(command(n)), back) != Verdict::kGood) ++refused, ++n;
  EXPECT_LE(refused, 2) << "92 tells its positions whole";
  EXPECT_TRUE(samples::same(back, command(n)));
}

TEST(HeaderCompression, WhoComesLateIgnoresWhatItCannotRestore) {
  Wire<StateBlock> wire;
  StateBlock back;
  for (std::uint32_t n = 1; n <= 40; ++n) (void)wire.sent(state(n));
  for (std::uint32_t n = 41; n < 64; ++n)
    EXPECT_EQ(wire.got(wire.sent(state(n)), back), Verdict::kUnknownSet) << n;
  EXPECT_EQ(wire.got(wire.sent(state(64)), back), Verdict::kGood) << "every 512 samples there is a set";
  EXPECT_TRUE(samples::same(back, state(64)));
  EXPECT_EQ(wire.got(wire.sent(state(65)), back), Verdict::kGood);
}

/// A new engagement, told in four blocks: one of them is enough, and without any of them nothing is believed.
TEST(HeaderCompression, AChangeIsNeverMissed) {
  for (std::uint32_t lost = 0; lost <= 5; ++lost) {
    Wire<CommandBlock> wire;
    CommandBlock back;
    for (std::uint32_t n = 0; n < 40; ++n) ASSERT_EQ(wire.got(wire.sent(command(n)), back), Verdict::kGood);
    for (std::uint32_t n = 40; n < 70; ++n) {
      CommandBlock block = command(n);
      block.engage = 4;
      const auto bytes = wire.sent(block);
      if (n < 40 + lost) continue;
      const Verdict verdict = wire.got(bytes, back);
      const bool known = lost < 4 || n >= 48;
      EXPECT_EQ(verdict, known ? Verdict::kGood : Verdict::kUnknownSet) << lost << ", " << n;
      if (known) {
        EXPECT_TRUE(samples::same(back, block)) << n;
      }
    }
  }
}

/// The light that goes off, told in two states and then in the 8th.
TEST(HeaderCompression, AStatesChangeIsToldThreeTimes) {
  for (std::uint32_t lost = 0; lost <= 3; ++lost) {
    Wire<StateBlock> wire;
    StateBlock back;
    for (std::uint32_t n = 0; n < 40; ++n) ASSERT_EQ(wire.got(wire.sent(state(n)), back), Verdict::kGood);
    std::size_t sets = 0;
    for (std::uint32_t n = 40; n < 63; ++n) {
      StateBlock block = state(n);
      block.guards ^= 1U;
      const auto bytes = wire.sent(block);
      sets += (bytes[4] & 0x40U) != 0 ? 1 : 0;
      if (n < 40 + lost) continue;
      const bool known = lost < 2 || n >= 48;
      EXPECT_EQ(wire.got(bytes, back), known ? Verdict::kGood : Verdict::kUnknownSet) << lost << ", " << n;
    }
    EXPECT_EQ(sets, 3u);
  }
}

/// Recorded and sent again, in other circumstances: the old block with its old stamps, or nothing.
TEST(HeaderCompression, AReplayIsNeverAYoungerBlock) {
  Wire<CommandBlock> wire;
  CommandBlock back;
  std::vector<std::vector<std::uint8_t>> recorded;
  for (std::uint32_t n = 0; n < 3000; ++n) {
    recorded.push_back(wire.sent(command(n)));
    ASSERT_EQ(wire.got(recorded.back(), back), Verdict::kGood);
  }
  int good = 0;
  for (std::uint32_t n = 0; n < 3000; ++n) {
    if (wire.got(recorded[n], back) != Verdict::kGood) continue;
    ++good;
    ASSERT_TRUE(samples::same(back, command(n))) << n;
  }
  EXPECT_GT(good, 0);
}

template <class Block, class Make>
void expect_damage_is_seen(const Make& make) {
  samples::Random random(8);
  Wire<Block> wire;
  Block back;
  int refused = 0;
  for (std::uint32_t n = 0; n < 20000; ++n) {
    const Block block = make(n);
    const auto bytes = wire.sent(block);
    auto damaged = bytes;
    if (random() % 3 == 0) damaged.resize(random() % bytes.size());
    for (std::size_t k = random() % 4 + 1; k > 0 && !damaged.empty(); --k)
      damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    const Verdict verdict = wire.got(damaged, back);
    if (verdict == Verdict::kGood) {
      ASSERT_TRUE(samples::same(back, block)) << "seed 8, block " << n;
    }
    refused += verdict == Verdict::kGood ? 0 : 1;
    ASSERT_EQ(wire.got(bytes, back), Verdict::kGood) << n << ": the damaged one has left nothing behind";
  }
  EXPECT_GT(refused, 19000);
}

TEST(HeaderCompression, DamagedBytesNeverBecomeAnotherBlock) {
  expect_damage_is_seen<CommandBlock>(command);
  expect_damage_is_seen<StateBlock>(state);
}

TEST(HeaderCompression, AnythingAtAllComesBack) {
  samples::Random random(3);
  Wire<CommandBlock> commands;
  Wire<StateBlock> states;
  for (int i = 0; i < 300; ++i) {
    const std::size_t size = i == 0 ? 0 : i == 1 ? Payload::kCapacity : random() % 300;
    const CommandBlock block = samples::command(random, size);
    CommandBlock back;
    ASSERT_EQ(commands.got(commands.sent(block), back), Verdict::kGood) << i;
    ASSERT_TRUE(samples::same(block, back)) << "seed 3, block " << i;
    const StateBlock other = samples::state(random, size);
    StateBlock other_back;
    ASSERT_EQ(states.got(states.sent(other), other_back), Verdict::kGood) << i;
    ASSERT_TRUE(samples::same(other, other_back)) << "seed 3, block " << i;
  }
}

TEST(HeaderCompression, BoundsAreKept) {
  Wire<CommandBlock> wire;
  CommandBlock block = command(0);
  block.payload.size = Payload::kCapacity + 1;
  EXPECT_TRUE(wire.sent(block).empty());
  for (const double wrong :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 200.0}) {
    block = command(0);
    block.anchor.position_m.x() = wrong;
    EXPECT_TRUE(wire.sent(block).empty()) << wrong;
  }
}

TEST(HeaderCompression, TheLastOfEachEnumerationIsTakenAndTheNextIsDamage) {
  const auto verdict = [](auto block, const auto& change) {
    change(block);
    Wire<decltype(block)> wire;
    return wire.got(wire.sent(block), block);
  };
  const auto after = [](auto last) { return static_cast<decltype(last)>(static_cast<int>(last) + 1); };
  const auto law = [&](Law value) { return verdict(command(0), [&](CommandBlock& b) { b.law = value; }); };
  EXPECT_EQ(law(Law::kRemoteAcceleration), Verdict::kGood);
  EXPECT_EQ(law(after(Law::kRemoteAcceleration)), Verdict::kDamaged);
  const auto interlock = [&](Interlock value) {
    return verdict(state(0), [&](StateBlock& b) { b.interlock = value; });
  };
  EXPECT_EQ(interlock(kLastInterlock), Verdict::kGood);
  EXPECT_EQ(interlock(after(kLastInterlock)), Verdict::kDamaged);
  const auto mode = [&](SlaveMode value) {
    return verdict(state(0), [&](StateBlock& b) { b.mode = value; });
  };
  EXPECT_EQ(mode(SlaveMode::kStopped), Verdict::kGood);
  EXPECT_EQ(mode(after(SlaveMode::kStopped)), Verdict::kDamaged);
  const auto reason = [&](HoldReason value) {
    return verdict(state(0), [&](StateBlock& b) { b.reason = value; });
  };
  EXPECT_EQ(reason(HoldReason::kStopped), Verdict::kGood);
  EXPECT_EQ(reason(after(HoldReason::kStopped)), Verdict::kDamaged);
  const auto beta = [&](double value) {
    return verdict(command(0), [&](CommandBlock& b) { b.beta = value; });
  };
  EXPECT_EQ(beta(0.5), Verdict::kGood);
  EXPECT_EQ(beta(std::numeric_limits<double>::quiet_NaN()), Verdict::kDamaged);
}

TEST(HeaderCompression, AnotherContractIsForeign) {
  Wire<CommandBlock> wire;
  CommandBlock back;
  EXPECT_EQ(wire.receiver.restore(wire.sent(command(0)), kMaster, kContract + 1, back),
            Verdict::kForeignContract);
}

TEST(HeaderCompression, SendersAreKeptApartAndStrangersMakeNobodyForgotten) {
  Wire<CommandBlock> one, other;
  CommandBlock back;
  for (std::uint32_t n = 0; n < 40; ++n) {
    ASSERT_EQ(one.got(one.sent(command(n)), back, kMaster), Verdict::kGood);
    CommandBlock block = command(n + 5000);
    block.epoch = 99;
    ASSERT_EQ(one.got(other.sent(block), back, kStranger), Verdict::kGood);
    ASSERT_TRUE(samples::same(back, block));
    for (std::uint8_t noise = 10; noise < 40; ++noise) {
      const std::vector<std::uint8_t> bytes(20, noise);
      EXPECT_NE(one.got(bytes, back, SenderKey{noise}), Verdict::kGood);
    }
  }
}

/// The bytes of docs/reference/block.md.
TEST(HeaderCompression, ABlockCostsThisManyBytes) {
  Wire<CommandBlock> commands;
  Wire<StateBlock> states;
  std::vector<std::size_t> command_heads, state_heads;
  for (std::uint32_t n = 32; n < 64; ++n) {
    const CommandBlock block = command(n);
    command_heads.push_back(commands.sent(block).size() - (block.payload.size - kPayloadPrefixBytes));
    const StateBlock other = state(n);
    state_heads.push_back(states.sent(other).size() - (other.payload.size - kPayloadPrefixBytes) -
                          (other.force.size - kPayloadPrefixBytes));
  }
  EXPECT_EQ(command_heads[0], 4u + 1u + 49u + 48u) << "with its set";
  EXPECT_EQ(command_heads[5], 4u + 1u + 6u + 12u) << "near";
  EXPECT_EQ(command_heads[12], 4u + 1u + 8u + 15u) << "far";
  EXPECT_EQ(state_heads[0], 4u + 1u + 78u + 84u);
  EXPECT_EQ(state_heads[5], 4u + 1u + 6u + 12u + 9u);
  EXPECT_EQ(state_heads[12], 4u + 1u + 8u + 15u + 9u);
}

}  // namespace
}  // namespace telekerf
