// SPDX-License-Identifier: Apache-2.0
// No jump, whatever happens: random sequences of engaging, clutching, scaling, losses, delay steps, circle
// handovers and stops, through the whole command path.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <random>
#include <string>

#include "master/station.h"
#include "slave/station.h"

namespace telekerf {
namespace {

constexpr double kH = 1e-3;
constexpr double kAllowed = 20.0 * kH + 1e-3;  ///< m/s a tick: the slave's acceleration limit, and 1 mm/s

/// A link with a delay that steps and a mouth that can be held shut.
template <class T>
struct Pipe {
  int delay = 20;
  std::deque<std::pair<std::int64_t, T>> under_way;
  void push(std::int64_t tick, const T& message) { under_way.emplace_back(tick + delay, message); }
  void take(std::int64_t tick, std::vector<Received<T>>& out) {
    out.clear();
    for (auto it = under_way.begin(); it != under_way.end();) {
      if (it->first <= tick) {
        out.push_back({it->second, tick * 1'000'000});
        it = under_way.erase(it);
      } else {
        ++it;
      }
    }
  }
};

/// The master's tool on arcs: position and direction go on, the curvature jumps.
struct Walker {
  Vec2 place = Vec2::Zero();
  double heading = 0.0;
  double speed = 0.02;
  double curvature = 100.0;

  control::KinematicState next() {
    // Keeps to the middle of the workspace: far out it turns inwards.
    if (place.norm() > 7e-3) {
      const Vec2 direction(std::cos(heading), std::sin(heading));
      const Vec2 inwards = -place;
      curvature = direction.x() * inwards.y() - direction.y() * inwards.x() >= 0.0 ? 300.0 : -300.0;
    }
    const double turn = speed * curvature * kH;
    place += speed * kH * Vec2(std::cos(heading + 0.5 * turn), std::sin(heading + 0.5 * turn));
    heading += turn;
    control::KinematicState motion;
    motion.position_m.head<2>() = place;
    motion.velocity_m_per_s.head<2>() = speed * Vec2(std::cos(heading), std::sin(heading));
    motion.acceleration_m_per_s2.head<2>() =
        speed * speed * curvature * Vec2(-std::sin(heading), std::cos(heading));
    return motion;
  }
};

struct Case {
  const char* law;
  int sequences;
};

class NoJump : public testing::TestWithParam<Case> {};

TEST_P(NoJump, NeitherTheReferenceNorTheMotion) {
  std::mt19937_64 random(GetParam().sequences);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  master::StationSettings master_settings;
  master_settings.node.command.law = master::kLaws.find(GetParam().law).value();
  master::CommandStream stream(master_settings.validated().node.command, 1);
  streaming::StateReceiver feedback(0.5, 1, 1);
  slave::StationSettings slave_settings;
  slave_settings.record_s = 0.01;
  slave::Station slave(slave_settings);

  Walker walker;
  Pipe<CommandBlock> forward;
  Pipe<StateBlock> backward;
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  StopOrder stop;
  std::uint32_t stops = 0;
  std::uint32_t engage = 0;
  bool engaged = false;
  bool stopped = false;
  double beta = 0.5;
  std::int64_t shut_until = 0;
  std::int64_t taken_elsewhere = -1;
  std::int64_t tick = 0;
  std::int64_t followed = 0;
  double largest_reference = 0.0;
  double largest_motion = 0.0;
  double largest_gap_m = 0.0;
  control::KinematicState last;
  Vec3 before_m = *slave.machine().true_tool_m();
  Vec3 last_step_m = Vec3::Zero();
  for (int sequence = 0; sequence < GetParam().sequences; ++sequence) {
    const int what = static_cast<int>(uniform(0.0, 8.0));
    if (what <= 1) engage += 1;
    if (what <= 1) engaged = true;
    if (what == 2) engaged = false;
    if (what == 3) beta = uniform(0.3, 1.0);
    if (what == 4) shut_until = tick + static_cast<std::int64_t>(uniform(10.0, 400.0));
    if (what == 5) forward.delay = static_cast<int>(uniform(5.0, 150.0));
    if (what == 6) {
      walker.curvature = uniform(-400.0, 400.0);
      walker.speed = std::clamp(walker.speed + uniform(-1e-3, 1e-3), 0.005, 0.03);
    }
    if (what == 7) {  // clutch: let go, move elsewhere, take hold again
      engaged = false;
      taken_elsewhere = tick + 20;  // not before the last block that was engaged is full
      if (uniform(0.0, 1.0) < 0.3) {
        stop.number = ++stops;
        stopped = true;
      }
    }
    if (what == 0 && stopped) {
      stop = {.number = 0, .cleared = {stops}};
      stopped = false;
    }
    const int length = static_cast<int>(uniform(25.0, 85.0));
    for (int n = 0; n < length; ++n, ++tick) {
      if (tick == taken_elsewhere) walker.place = Vec2(uniform(-5e-3, 5e-3), uniform(-5e-3, 5e-3));
      backward.take(tick, states);
      for (const auto& state : states) stream.received(feedback.receive(state));
      const auto block = stream.step(tick * 1'000'000, static_cast<Tick>(tick),
                                     {.tool = walker.next(),
                                      .beta = beta,
                                      .engaged = engaged,
                                      .engage = engage,
                                      .echo_sequence = feedback.heard() ? feedback.header().sequence : 0,
                                      .echo_sent_ns = feedback.heard() ? feedback.header().sent_ns : 0});
      if (block && tick >= shut_until) forward.push(tick, *block);
      forward.take(tick, commands);
      const auto out = slave.step(tick * 1'000'000, nullptr, commands, stop);
      if (out.state) backward.push(tick, *out.state);
      followed += out.applied_tick >= 0.0 ? 1 : 0;

      if (tick > 0) {
        const Vec3 velocity_step = out.reference.velocity_m_per_s - last.velocity_m_per_s;
        const Vec3 gap =
            out.reference.position_m -
            (last.position_m + 0.5 * kH * (last.velocity_m_per_s + out.reference.velocity_m_per_s));
        largest_reference = std::max(largest_reference, velocity_step.norm());
        largest_gap_m = std::max(largest_gap_m, gap.norm());
        ASSERT_LT(velocity_step.norm(), kAllowed)
            << GetParam().law << " sequence " << sequence << " of kind " << what << ", tick " << tick;
        ASSERT_LT(gap.norm(), 0.5 * kH * kAllowed)
            << GetParam().law << " sequence " << sequence << " of kind " << what << ", tick " << tick;
      }
      const Vec3 now_m = *slave.machine().true_tool_m();
      const Vec3 step_m = now_m - before_m;
      largest_motion = std::max(largest_motion, (step_m - last_step_m).norm() / kH);
      ASSERT_LT((step_m - last_step_m).norm() / kH, kAllowed)
          << GetParam().law << " sequence " << sequence << " of kind " << what << ", tick " << tick;
      // No clipping hides a jump. (Bare accelerations may lead out of bounds, and are stopped there.)
      if (std::string(GetParam().law) != "remote-acceleration") {
        ASSERT_LT(out.reference.position_m.norm(), 0.026) << "the workspace ends at 27.2 mm";
      }
      before_m = now_m;
      last_step_m = step_m;
      last = out.reference;
    }
  }
  EXPECT_GT(followed, tick / 10) << "it did follow";
  std::printf(
      "%s: largest velocity step of the reference %.2f mm/s, of the tool %.2f mm/s; gap %.3f um; "
      "followed %.0f %%\n",
      GetParam().law, largest_reference * 1e3, largest_motion * 1e3, largest_gap_m * 1e6,
      100.0 * static_cast<double>(followed) / static_cast<double>(tick));
}

INSTANTIATE_TEST_SUITE_P(Laws, NoJump,
                         testing::Values(Case{"anchored", 6000}, Case{"local", 2000},
                                         Case{"remote-acceleration", 2000}));

}  // namespace
}  // namespace telekerf
