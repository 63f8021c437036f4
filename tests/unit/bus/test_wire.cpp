// SPDX-License-Identifier: Apache-2.0
#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>
#include <gtest/gtest.h>
#include <telekerf.h>

#include <limits>

#include "common/bus/wire.h"
#include "tests/unit/bus/samples.h"

namespace telekerf::bus {
namespace {

constexpr std::uint16_t kContract = 7;

/// to_wire, then from_wire under `contract`.
template <class Wire, class T>
Verdict sent(const T& value, T& back, std::uint16_t contract = kContract) {
  Wire wire;
  EXPECT_TRUE(to_wire(value, kContract, wire));
  return from_wire(wire, contract, back);
}

TEST(Wire, BlocksComeBackAsTheyWere) {
  samples::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = i == 0 ? 0 : i == 1 ? Payload::kCapacity : random() % 300;
    const CommandBlock command = samples::command(random, size);
    CommandBlock command_back;
    ASSERT_EQ((sent<wire::CommandBlock>(command, command_back)), Verdict::kGood);
    ASSERT_TRUE(samples::same(command, command_back)) << "seed 1, block " << i;
    const StateBlock state = samples::state(random, size);
    StateBlock state_back;
    ASSERT_EQ((sent<wire::StateBlock>(state, state_back)), Verdict::kGood);
    ASSERT_TRUE(samples::same(state, state_back)) << "seed 1, block " << i;
  }
}

TEST(Wire, RoundedIsWhatTheReceiverSees) {
  CommandBlock block;
  block.anchor.position_m = Vec3(0.1, -1.0 / 3.0, 1e-9);
  block.anchor.velocity_m_per_s = Vec3(0.7, 1e-12, -0.3);
  block.beta = 0.3;
  CommandBlock back;
  ASSERT_EQ((sent<wire::CommandBlock>(block, back)), Verdict::kGood);
  EXPECT_FALSE(samples::same(block.anchor, back.anchor));
  EXPECT_TRUE(samples::same(to_wire_precision(block.anchor), back.anchor));
  EXPECT_EQ(back.beta, to_wire_precision(0.3));
}

TEST(Wire, SlowMessagesComeBackAsTheyWere) {
  samples::Random random(2);
  const ContourMessage contour = samples::contour(random, 5000);
  ContourMessage contour_back;
  ASSERT_EQ((sent<wire::Contour>(contour, contour_back)), Verdict::kGood);
  EXPECT_TRUE(samples::same(contour, contour_back));

  const EventMessage event{.epoch = 3, .kind = EventMessage::Kind::kSetBeta, .value = 0.25, .text = "finer"};
  EventMessage event_back;
  ASSERT_EQ((sent<wire::Event>(event, event_back)), Verdict::kGood);
  EXPECT_TRUE(samples::same(event, event_back));

  const TelemetryMessage telemetry{
      .role = "slave", .tick = 12, .values = {{"slack_p99_s", 1e-3}, {"drops", 2}}};
  TelemetryMessage telemetry_back;
  ASSERT_EQ((sent<wire::Telemetry>(telemetry, telemetry_back)), Verdict::kGood);
  EXPECT_TRUE(samples::same(telemetry, telemetry_back));

  const PresenceMessage presence{.contract = 1,
                                 .cell = "cell-1",
                                 .role = "slave",
                                 .name = "left",
                                 .epoch = 4,
                                 .joined = true,
                                 .version = "0.1.0"};
  PresenceMessage presence_back;
  ASSERT_TRUE(read_presence(presence_bytes(presence), presence_back));
  EXPECT_EQ(presence_back.contract, 1);
  EXPECT_EQ(presence_back.cell, "cell-1");
  EXPECT_EQ(presence_back.role, "slave");
  EXPECT_EQ(presence_back.name, "left");
  EXPECT_EQ(presence_back.epoch, 4u);
  EXPECT_TRUE(presence_back.joined);
  EXPECT_EQ(presence_back.version, "0.1.0");
}

TEST(Wire, AnotherContractIsForeign) {
  samples::Random random(3);
  CommandBlock command;
  EXPECT_EQ((sent<wire::CommandBlock>(samples::command(random, 9), command, 8)), Verdict::kForeignContract);
  StateBlock state;
  EXPECT_EQ((sent<wire::StateBlock>(samples::state(random, 9), state, 8)), Verdict::kForeignContract);
  ContourMessage contour;
  EXPECT_EQ((sent<wire::Contour>(samples::contour(random, 9), contour, 8)), Verdict::kForeignContract);
  EventMessage event;
  EXPECT_EQ((sent<wire::Event>(EventMessage{}, event, 8)), Verdict::kForeignContract);
  TelemetryMessage telemetry;
  EXPECT_EQ((sent<wire::Telemetry>(TelemetryMessage{}, telemetry, 8)), Verdict::kForeignContract);
}

TEST(Wire, TheChecksumCoversEveryField) {
  samples::Random random(4);
  wire::CommandBlock good;
  ASSERT_TRUE(to_wire(samples::command(random, 40), kContract, good));
  CommandBlock back;
  const auto damaged = [&](auto&& damage) {
    wire::CommandBlock wire = good;
    damage(wire);
    return from_wire(wire, kContract, back) == Verdict::kDamaged;
  };
  EXPECT_FALSE(damaged([](auto&) {}));
  EXPECT_TRUE(damaged([](auto& w) { w.checksum() ^= 1u; }));
  EXPECT_TRUE(damaged([](auto& w) { w.contract() ^= 1u; }));
  EXPECT_TRUE(damaged([](auto& w) { w.engaged() ^= 1u; }));
  EXPECT_TRUE(damaged([](auto& w) { w.first_tick() ^= 1u << 31; }));
  EXPECT_TRUE(damaged([](auto& w) { w.number() ^= 1u; }));
  EXPECT_TRUE(damaged([](auto& w) { w.beta() = -w.beta(); }));
  EXPECT_TRUE(damaged([](auto& w) { w.anchor().position_m()[2] += 1e-3f; }));
  EXPECT_TRUE(damaged([](auto& w) { w.payload().back() ^= 128u; }));
  EXPECT_TRUE(damaged([](auto& w) { w.payload().pop_back(); }));

  wire::StateBlock state;
  ASSERT_TRUE(to_wire(samples::state(random, 40), kContract, state));
  StateBlock state_back;
  ASSERT_EQ(from_wire(state, kContract, state_back), Verdict::kGood);
  state.force().back() ^= 1u;
  EXPECT_EQ(from_wire(state, kContract, state_back), Verdict::kDamaged);
}

TEST(Wire, PayloadsKeepTheirBounds) {
  samples::Random random(9);
  for (const auto part : {&StateBlock::payload, &StateBlock::force}) {
    StateBlock full = samples::state(random, 0);
    samples::fill(random, full.*part, Payload::kCapacity);
    StateBlock back;
    EXPECT_EQ((sent<wire::StateBlock>(full, back)), Verdict::kGood);
    EXPECT_TRUE(samples::same(full, back));
    (full.*part).size = Payload::kCapacity + 1;
    wire::StateBlock wire;
    EXPECT_FALSE(to_wire(full, kContract, wire));
  }
  wire::StateBlock hostile;
  hostile.contract(kContract);
  hostile.force().assign(Payload::kCapacity + 1, 0);
  StateBlock back;
  EXPECT_EQ(from_wire(hostile, kContract, back), Verdict::kDamaged) << "before its checksum is looked at";
}

TEST(Wire, ValuesThatNoSenderMakesAreDamage) {
  samples::Random random(5);
  wire::CommandBlock command;
  ASSERT_TRUE(to_wire(samples::command(random, 4), kContract, command));
  command.law(9);
  command.checksum(checksum_of(command));
  CommandBlock block;
  EXPECT_EQ(from_wire(command, kContract, block), Verdict::kDamaged);

  CommandBlock infinite;
  infinite.anchor.position_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ((sent<wire::CommandBlock>(infinite, block)), Verdict::kDamaged);

  wire::Event event;
  ASSERT_TRUE(to_wire(EventMessage{}, kContract, event));
  event.kind(99);
  EventMessage message;
  EXPECT_EQ(from_wire(event, kContract, message), Verdict::kDamaged);

  ContourMessage contour = samples::contour(random, 3);
  contour.points_m[1].x() = std::numeric_limits<double>::quiet_NaN();
  ContourMessage back;
  EXPECT_EQ((sent<wire::Contour>(contour, back)), Verdict::kDamaged);

  // Lines that claim more points than came, and points that belong to no line.
  for (const std::uint32_t claimed : {3u, 1u, 0xffffffffu}) {
    wire::Contour lines;
    ASSERT_TRUE(to_wire(samples::contour(random, 4), kContract, lines));
    ASSERT_EQ(lines.further()[2].points(), 2u);
    lines.further()[2].points(claimed);
    EXPECT_EQ(from_wire(lines, kContract, back), Verdict::kDamaged) << claimed;
  }
}

/// Golden: zlib.crc32(bytes(92)), over a block whose CDR anyone can write down.
TEST(Wire, ChecksumOfAnEmptyBlock) {
  wire::CommandBlock wire;
  // 92 zero octets follow the checksum: 2+1+1, 4+4, 8+8+8, 4+4+4, 24, 2 (+2 padding), 4+4+4, 4; zlib says:
  EXPECT_EQ(checksum_of(wire), 0xc2b526e7u);
}

/// Flipped, cut or replaced octets of a sample: refused, or the very same block (CDR's padding means
/// nothing).
TEST(Wire, DamagedBytesNeverBecomeAnotherBlock) {
  using eprosima::fastcdr::Cdr;
  using eprosima::fastcdr::FastBuffer;
  samples::Random random(8);
  const StateBlock sent_block = samples::state(random, 60);
  wire::StateBlock wire;
  ASSERT_TRUE(to_wire(sent_block, kContract, wire));
  std::vector<char> bytes(400);
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr writer(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire.serialize(writer);
  bytes.resize(writer.getSerializedDataLength());

  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<char> damaged = bytes;
    if (random() % 3 == 0) damaged.resize(random() % bytes.size());
    for (std::size_t n = random() % 4 + 1; n > 0 && !damaged.empty(); --n) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    FastBuffer view(damaged.data(), damaged.size());
    Cdr reader(view, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
    wire::StateBlock arrived;
    StateBlock block;
    bool good = false;
    try {
      arrived.deserialize(reader);
      good = from_wire(arrived, kContract, block) == Verdict::kGood;
    } catch (const eprosima::fastcdr::exception::Exception&) {
    }
    if (good) {
      ASSERT_TRUE(samples::same(block, sent_block)) << "seed 8, round " << round;
    }
    refused += good ? 0 : 1;
  }
  EXPECT_GT(refused, 19000);
}

}  // namespace
}  // namespace telekerf::bus
