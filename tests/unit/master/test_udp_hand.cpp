// SPDX-License-Identifier: Apache-2.0
// A hand that comes by datagrams, and what it does to a simulated master.
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <filesystem>
#include <limits>
#include <utility>

#include "common/geometry/nearest.h"
#include "common/runtime/startup_error.h"
#include "experiments/simulation/simulation.h"
#include "master/operator/recorded_hand.h"
#include "master/operator/space_mouse.h"
#include "master/operator/udp_hand.h"
#include "master/station.h"
#include "tests/unit/allocations.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(HandSetting, WhatIsNoneIsRefusedWithWhatItMustBe) {
  for (const char* wrong : {"", "mouse", "browsers"})
    EXPECT_NE(
        validate_hand(wrong).find(
            "must be one of simulated, browser, browser:HOST:PORT, udp:HOST:PORT, evdev:PATH, spacemouse, "
            "spacemouse:PATH, recorded:FILE"),
        std::string::npos)
        << wrong;
  EXPECT_EQ(validate_hand("browser"), "");
  EXPECT_NE(validate_hand("browser:here"), "");
  EXPECT_NE(validate_hand("recorded"), "");
  EXPECT_EQ(open_hand("simulated", SpaceMouseSettings{}), nullptr);
  EXPECT_THROW((void)open_hand("recorded:nowhere.csv", SpaceMouseSettings{}), StartupError);
}

class UdpHandTest : public ::testing::Test {
 protected:
  using Socket = boost::asio::ip::udp::socket;
  void tell(Socket& from, std::uint32_t flags, std::uint32_t session = 7) {
    UdpHandFrame frame;
    frame.session = session;
    frame.flags = flags;
    frame.sequence = ++sequence;
    frame.sent_ns = now_ns - kMs;
    frame.x_m = 1e-3;
    frame.y_m = -2e-3;
    from.send_to(boost::asio::buffer(&frame, sizeof(frame)),
                 {boost::asio::ip::address_v4::loopback(), hand.port()});
  }

  UdpHand hand{{"127.0.0.1", 0}};
  boost::asio::io_context context;
  Socket page{context, {boost::asio::ip::address_v4::loopback(), 0}};
  Socket stranger{context, {boost::asio::ip::address_v4::loopback(), 0}};
  std::uint64_t sequence = 0;
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(UdpHandTest, PullsWhereItSaysAsLongAsItSpeaks) {
  tell(page, 0);
  EXPECT_FALSE(hand.sample(now_ns).held);
  tell(page, UdpHandFrame::kHeld | UdpHandFrame::kTrigger);
  const auto before = testing::allocations();
  const OperatorSample held = hand.sample(now_ns);
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(held.held && held.trigger);
  ASSERT_TRUE(held.pointer_m);
  EXPECT_EQ(*held.pointer_m, Vec2(1e-3, -2e-3));
  now_ns += OperatorLease::kSilence_ns;
  const OperatorSample silent = hand.sample(now_ns);
  EXPECT_FALSE(silent.held || silent.trigger || silent.pointer_m);
}

TEST_F(UdpHandTest, WhatIsLongerOrPullsToNoPlaceIsRefused) {
  tell(page, 0);
  tell(page, UdpHandFrame::kHeld);
  EXPECT_TRUE(hand.sample(now_ns).held);
  const auto refuses = [&](double x_m, double y_m, std::size_t more) {
    std::pair<UdpHandFrame, std::byte> frame;
    frame.first.session = 7;
    frame.first.flags = UdpHandFrame::kTrigger;
    frame.first.sequence = ++sequence;
    frame.first.sent_ns = now_ns;
    frame.first.x_m = x_m;
    frame.first.y_m = y_m;
    const std::uint64_t before = hand.refused();
    page.send_to(boost::asio::buffer(&frame, sizeof(UdpHandFrame) + more),
                 {boost::asio::ip::address_v4::loopback(), hand.port()});
    return !hand.sample(now_ns).trigger && hand.refused() == before + 1;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinite, -kInfinite}) {
    EXPECT_TRUE(refuses(bad, 0.0, 0)) << bad;
    EXPECT_TRUE(refuses(0.0, bad, 0)) << bad;
  }
  EXPECT_TRUE(refuses(0.0, 0.0, 1));
  EXPECT_FALSE(refuses(0.0, 0.0, 0));
}

TEST_F(UdpHandTest, AStrangerIsNotHeardWhileItSpeaks) {
  tell(page, 0);
  tell(stranger, UdpHandFrame::kHeld);
  tell(page, 0, 8);  // another session of the same sender
  EXPECT_FALSE(hand.sample(now_ns).held);
  EXPECT_EQ(hand.counters().taken, 1u);
  now_ns += OperatorLease::kSilence_ns;
  tell(stranger, 0);
  tell(stranger, UdpHandFrame::kHeld);
  EXPECT_TRUE(hand.sample(now_ns).held);
}

TEST_F(UdpHandTest, AnswersWhatCountedAndThatAHoldHasEnded) {
  const auto answer = [&]() -> std::optional<UdpHandAnswer> {
    hand.answer({.now_ns = now_ns, .guided = true, .tool_m = {0.5, 0.25}, .force_n = {1.0, 0.0}});
    page.non_blocking(true);
    UdpHandAnswer told;
    boost::system::error_code error;
    page.receive(boost::asio::buffer(&told, sizeof(told)), 0, error);
    if (error) return std::nullopt;
    return told;
  };
  (void)hand.sample(now_ns);
  EXPECT_FALSE(answer()) << "nothing was said";
  tell(page, 0);
  tell(page, UdpHandFrame::kHeld);
  (void)hand.sample(now_ns);
  const auto held = answer();
  ASSERT_TRUE(held);
  EXPECT_EQ(held->sequence, 2u);
  EXPECT_EQ(held->step_ns, now_ns);
  EXPECT_EQ(held->flags, UdpHandAnswer::kHeld | UdpHandAnswer::kGuided);
  EXPECT_EQ(held->y_m, 0.25);
  (void)hand.sample(now_ns += kMs);
  EXPECT_FALSE(answer()) << "no news";
  (void)hand.sample(now_ns += 100 * kMs);
  const auto released = answer();
  ASSERT_TRUE(released);
  EXPECT_EQ(released->flags, UdpHandAnswer::kGuided);
}

/// Pulls at a place of the work, by the world's word.
struct Pointer : OperatorInput {
  explicit Pointer(const std::optional<Vec2>& place_m) : at_m(place_m) {}
  OperatorSample sample(std::int64_t) noexcept override {
    return {.trigger = false, .held = at_m.has_value(), .force_n = {}, .pointer_m = at_m};
  }
  void answer(const OperatorAnswer& told) noexcept override { answered = told; }
  const std::optional<Vec2>& at_m;
  OperatorAnswer answered;
};

TEST(HandOnTheMaster, IsConfinedToTheLineWhereverThePointerPulls) {
  const ContourMessage contour = simulation::find_contour({});
  std::optional<Vec2> pull_m;
  auto device = std::make_unique<Pointer>(pull_m);
  const Pointer& pointer = *device;
  StationSettings settings;
  settings.record_s = 0.0;
  Station station(settings, {}, {}, std::move(device));
  const auto task = station.prepare(contour);
  const geometry::NearestIndex line({contour.points_m, contour.closed});
  std::int64_t now_ns = 0;
  const auto run = [&](double s) {
    double off_m = 0.0;
    for (const std::int64_t end_ns = now_ns + static_cast<std::int64_t>(s * 1e9); now_ns < end_ns;
         now_ns += kMs) {
      (void)station.step(now_ns, task.get(), {}, {});
      off_m = std::max(off_m, (line.find(pointer.answered.tool_m).point_m - pointer.answered.tool_m).norm());
    }
    return off_m;
  };
  (void)run(4.0);
  ASSERT_TRUE(pointer.answered.guided);
  const Vec2 start_m = pointer.answered.tool_m;
  (void)run(1.0);
  EXPECT_LT((pointer.answered.tool_m - start_m).norm(), 50e-6) << "nobody pulls";

  // Half round, the pointer ahead of the tool.
  const double begin_m = line.find(start_m).arc_length_m;
  for (double arc_m = 0.0; arc_m < 0.05; arc_m += 20e-6) {
    pull_m = line.at(std::fmod(begin_m + arc_m, line.length_m())).point_m;
    EXPECT_LT(run(1e-3), 60e-6);
  }
  (void)run(1.0);
  EXPECT_LT((pointer.answered.tool_m - *pull_m).norm(), 0.5e-3) << "it follows";

  // 5 mm off, at right angles to the line.
  const geometry::Nearest place = line.find(pointer.answered.tool_m);
  pull_m = place.point_m + 5e-3 * Vec2(-place.tangent.y(), place.tangent.x());
  EXPECT_LT(run(2.0), 0.3e-3);
  EXPECT_GT(pointer.answered.force_n.norm(), 2.0) << "and it is pulled hard";
  pull_m.reset();
  (void)run(0.5);
  EXPECT_EQ(pointer.answered.force_n.norm(), 0.0);
}

TEST(RecordedHand, DoesOnceMoreWhatItsRowsSay) {
  std::vector<MasterRow> rows(5);
  rows[2].guided = rows[3].guided = true;
  rows[2].hand_n = {1.0, 0.0, 0.0};
  rows[3].hand_n = {2.0, 0.0, 0.0};
  rows[3].button = true;
  RecordedHand hand(rows);
  EXPECT_FALSE(hand.sample(0).held) << "nothing holds the tool yet";
  hand.answer({.now_ns = 0, .guided = true, .tool_m = Vec2::Zero(), .force_n = Vec2::Zero()});
  EXPECT_EQ(hand.sample(0).force_n->x(), 1.0);
  const OperatorSample second = hand.sample(0);
  EXPECT_EQ(second.force_n->x(), 2.0);
  EXPECT_TRUE(second.trigger);
  EXPECT_FALSE(hand.sample(0).held);
  EXPECT_FALSE(hand.sample(0).held) << "the record has ended";
}

}  // namespace
}  // namespace telekerf::master
