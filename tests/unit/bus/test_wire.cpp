// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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

/// Of a stream's end each.
template <class Wire, class Block>
Verdict streamed(const Block& block, Block& back) {
  ToWire<Block> to;
  FromWire<Block> from;
  Wire wire;
  EXPECT_TRUE(to(block, kContract, wire));
  return from(wire, {}, kContract, back);
}

TEST(Wire, BlocksComeBackAsTheyWere) {
  samples::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = i == 0 ? 0 : i == 1 ? Payload::kCapacity : random() % 300;
    const CommandBlock command = samples::command(random, size);
    CommandBlock command_back;
    ASSERT_EQ((streamed<wire::CommandBlock>(command, command_back)), Verdict::kGood);
    ASSERT_TRUE(samples::same(command, command_back)) << "seed 1, block " << i;
    const StateBlock state = samples::state(random, size);
    StateBlock state_back;
    ASSERT_EQ((streamed<wire::StateBlock>(state, state_back)), Verdict::kGood);
    ASSERT_TRUE(samples::same(state, state_back)) << "seed 1, block " << i;
  }
}

TEST(Wire, RoundedIsWhatTheReceiverSees) {
  CommandBlock block;
  block.anchor.position_m = Vec3(0.1, -1.0 / 3.0, 1e-9);
  block.anchor.velocity_m_per_s = Vec3(0.7, 1e-12, -0.3);
  block.beta = 0.3;
  CommandBlock back;
  ASSERT_EQ((streamed<wire::CommandBlock>(block, back)), Verdict::kGood);
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

  const PreviewMessage preview{7, -0.01, 0.02, 0.03, 0.04, {0xff, 0xd8, 0, 1}};
  PreviewMessage preview_back;
  ASSERT_EQ((sent<wire::Preview>(preview, preview_back)), Verdict::kGood);
  EXPECT_EQ(preview_back.contour_id, 7u);
  EXPECT_EQ(preview_back.left_m, -0.01);
  EXPECT_EQ(preview_back.top_m, 0.02);
  EXPECT_EQ(preview_back.width_m, 0.03);
  EXPECT_EQ(preview_back.height_m, 0.04);
  EXPECT_EQ(preview_back.jpeg, preview.jpeg);

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
  ContourMessage contour;
  EXPECT_EQ((sent<wire::Contour>(samples::contour(random, 9), contour, 8)), Verdict::kForeignContract);
  PreviewMessage preview;
  EXPECT_EQ((sent<wire::Preview>(PreviewMessage{0, 0.0, 0.0, 1.0, 1.0, {}}, preview, 8)),
            Verdict::kForeignContract);
  EventMessage event;
  EXPECT_EQ((sent<wire::Event>(EventMessage{}, event, 8)), Verdict::kForeignContract);
  TelemetryMessage telemetry;
  EXPECT_EQ((sent<wire::Telemetry>(TelemetryMessage{}, telemetry, 8)), Verdict::kForeignContract);
}

TEST(Wire, ValuesThatNoSenderMakesAreDamage) {
  samples::Random random(5);
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

}  // namespace
}  // namespace telekerf::bus
