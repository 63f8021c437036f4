// SPDX-License-Identifier: Apache-2.0
// The bounds of idl/telekerf.idl, on the way out and on the way in: exactly that many, and one more.
#include <gtest/gtest.h>

#include <limits>

#include "common/bus/wire.h"
#include "tests/unit/bus/samples.h"

namespace telekerf::bus {
namespace {

constexpr std::uint16_t kContract = 7;

template <class Wire, class T>
bool sends(const T& value) {
  Wire wire;
  return to_wire(value, kContract, wire);
}

/// A contour of so many points, and of further lines with so many points in all.
ContourMessage contour_of(std::size_t points, std::size_t lines, std::size_t further_points) {
  ContourMessage message;
  message.points_m.resize(points, Vec2(1e-3, 2e-3));
  message.further.resize(lines);
  if (lines > 0) message.further.back().points_m.resize(further_points, Vec2(3e-3, 4e-3));
  return message;
}

TEST(WireBounds, TheSenderKeepsThem) {
  EXPECT_TRUE(sends<wire::Contour>(contour_of(100'000, 1000, 100'000)));
  EXPECT_FALSE(sends<wire::Contour>(contour_of(100'001, 0, 0)));
  EXPECT_FALSE(sends<wire::Contour>(contour_of(0, 1001, 0)));
  EXPECT_FALSE(sends<wire::Contour>(contour_of(0, 1, 100'001)));
  ContourMessage spread = contour_of(0, 2, 50'000);
  spread.further[0].points_m.resize(50'001);
  EXPECT_FALSE(sends<wire::Contour>(spread)) << "of all further lines together";
  ContourMessage named;
  named.source.assign(256, 'x');
  named.mode.assign(32, 'x');
  EXPECT_TRUE(sends<wire::Contour>(named));
  ContourMessage long_source = named, long_mode = named;
  long_source.source += 'x';
  long_mode.mode += 'x';
  EXPECT_FALSE(sends<wire::Contour>(long_source));
  EXPECT_FALSE(sends<wire::Contour>(long_mode));

  PreviewMessage preview{1, 0.0, 0.0, 1.0, 1.0, std::vector<std::uint8_t>(262'144)};
  EXPECT_TRUE(sends<wire::Preview>(preview));
  preview.jpeg.push_back(0);
  EXPECT_FALSE(sends<wire::Preview>(preview));

  EventMessage event;
  event.text.assign(256, 'x');
  EXPECT_TRUE(sends<wire::Event>(event));
  event.text += 'x';
  EXPECT_FALSE(sends<wire::Event>(event));

  TelemetryMessage telemetry;
  telemetry.role.assign(32, 'x');
  telemetry.values.assign(256, {std::string(64, 'n'), 1.0});
  EXPECT_TRUE(sends<wire::Telemetry>(telemetry));
  TelemetryMessage role = telemetry, many = telemetry, name = telemetry;
  role.role += 'x';
  many.values.emplace_back("n", 1.0);
  name.values.back().first += 'n';
  EXPECT_FALSE(sends<wire::Telemetry>(role));
  EXPECT_FALSE(sends<wire::Telemetry>(many));
  EXPECT_FALSE(sends<wire::Telemetry>(name));
}

TEST(WireBounds, TheReceiverKeepsThem) {
  const auto arrives = [](const auto& change) {
    wire::Contour wire;
    EXPECT_TRUE(to_wire(contour_of(100'000, 1000, 100'000), kContract, wire));
    change(wire);
    ContourMessage back;
    return from_wire(wire, kContract, back) == Verdict::kGood;
  };
  EXPECT_TRUE(arrives([](wire::Contour&) {}));
  EXPECT_FALSE(arrives([](wire::Contour& w) { w.points().emplace_back(); }));
  EXPECT_FALSE(arrives([](wire::Contour& w) { w.further().emplace_back(); })) << "a 1001st line, of no point";
  EXPECT_FALSE(arrives([](wire::Contour& w) {
    w.further_points().emplace_back();
    w.further().back().points(100'001);
  })) << "as many points as its line says, and one too many";
  EXPECT_FALSE(
      arrives([](wire::Contour& w) { w.metres_per_pixel(std::numeric_limits<double>::infinity()); }));
  EXPECT_FALSE(arrives([](wire::Contour& w) { w.deviation_m(std::numeric_limits<double>::quiet_NaN()); }));
  EXPECT_FALSE(
      arrives([](wire::Contour& w) { w.points()[7].y_m(std::numeric_limits<double>::quiet_NaN()); }));
  EXPECT_FALSE(
      arrives([](wire::Contour& w) { w.further_points()[7].x_m(std::numeric_limits<double>::infinity()); }));

  const auto shows = [](const auto& change) {
    wire::Preview wire;
    EXPECT_TRUE(
        to_wire(PreviewMessage{1, 0.0, 0.0, 1.0, 1.0, std::vector<std::uint8_t>(262'144)}, kContract, wire));
    change(wire);
    PreviewMessage back;
    return from_wire(wire, kContract, back) == Verdict::kGood;
  };
  EXPECT_TRUE(shows([](wire::Preview&) {}));
  EXPECT_FALSE(shows([](wire::Preview& w) { w.jpeg().push_back(0); }));
  for (const double size_m :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(shows([=](wire::Preview& w) { w.width_m(size_m); })) << size_m;
    EXPECT_FALSE(shows([=](wire::Preview& w) { w.height_m(size_m); })) << size_m;
  }
  EXPECT_FALSE(shows([](wire::Preview& w) { w.left_m(std::numeric_limits<double>::quiet_NaN()); }));
  EXPECT_FALSE(shows([](wire::Preview& w) { w.top_m(std::numeric_limits<double>::infinity()); }));

  wire::Telemetry telemetry;
  TelemetryMessage message;
  telemetry.contract(kContract);
  telemetry.values().resize(256);
  EXPECT_EQ(from_wire(telemetry, kContract, message), Verdict::kGood);
  telemetry.values().resize(257);
  EXPECT_EQ(from_wire(telemetry, kContract, message), Verdict::kDamaged);
}

TEST(WireBounds, TheLastOfEachEnumerationIsTakenAndTheNextIsDamage) {
  const auto event = [](std::uint8_t kind, double value = 0.0) {
    wire::Event wire;
    wire.contract(kContract);
    wire.kind(kind);
    wire.value(value);
    EventMessage message;
    return from_wire(wire, kContract, message);
  };
  const auto last_kind = static_cast<std::uint8_t>(EventMessage::Kind::kSetStream);
  EXPECT_EQ(event(last_kind), Verdict::kGood);
  EXPECT_EQ(event(last_kind + 1), Verdict::kDamaged);
  EXPECT_EQ(event(0, std::numeric_limits<double>::quiet_NaN()), Verdict::kDamaged);
}

PresenceMessage longest_presence() {
  return {.contract = 0xABCD,
          .cell = std::string(64, 'c'),
          .role = std::string(32, 'r'),
          .name = std::string(64, 'n'),
          .epoch = 0xFFFFFFFF,
          .joined = true,
          .version = std::string(32, 'v')};
}

TEST(WireBounds, PresenceHoldsNamesOfTheirLengths) {
  const std::vector<std::uint8_t> bytes = presence_bytes(longest_presence());
  PresenceMessage back;
  ASSERT_TRUE(read_presence(bytes, back));
  EXPECT_EQ(back.cell + back.role + back.name + back.version,
            std::string(64, 'c') + std::string(32, 'r') + std::string(64, 'n') + std::string(32, 'v'));
  EXPECT_EQ(back.epoch, 0xFFFFFFFF);
  for (const auto text :
       {&PresenceMessage::cell, &PresenceMessage::role, &PresenceMessage::name, &PresenceMessage::version}) {
    PresenceMessage longer = longest_presence();
    longer.*text += 'x';
    EXPECT_TRUE(presence_bytes(longer).empty());
  }
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(read_presence(std::span(bytes).first(size), back)) << size;
}

/// Whatever the bytes claim, no text is longer than they are, and what is taken reads back as it was.
TEST(WireBounds, AnyBytesAsPresenceAreRefusedOrReadWithinThem) {
  samples::Random random(7);
  const std::vector<std::uint8_t> good = presence_bytes(longest_presence());
  int taken = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::uint8_t> bytes = good;
    if (i % 2 == 0) {
      bytes.resize(random() % 80);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    } else {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    PresenceMessage presence;
    if (!read_presence(bytes, presence)) continue;
    ++taken;
    const std::size_t letters =
        presence.cell.size() + presence.role.size() + presence.name.size() + presence.version.size();
    EXPECT_LE(letters, bytes.size()) << i;
    PresenceMessage again;
    const auto rewritten = presence_bytes(presence);
    ASSERT_TRUE(rewritten.empty() || read_presence(rewritten, again)) << i;
    if (!rewritten.empty()) {
      EXPECT_EQ(presence_bytes(again), rewritten) << i;
    }
  }
  EXPECT_GT(taken, 1000) << "a changed letter is a letter";
  EXPECT_LT(taken, 2000) << "noise is hardly ever a presence";
}

}  // namespace
}  // namespace telekerf::bus
