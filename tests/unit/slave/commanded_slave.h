// SPDX-License-Identifier: Apache-2.0
// A slave station without network, and hand-made commands that lead it round a circle.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/codec/encoder.h"
#include "common/protocol/wire_precision.h"
#include "slave/station.h"

namespace telekerf::slave {

constexpr std::int64_t kMs = 1'000'000;

/// A master that traces a circle of 5 mm radius at 20 mm/s. Whatever is tested: the beam burns only where the
/// interlock allows it on a sample of the stream that is followed.
class SlaveNodeTest : public testing::Test {
 protected:
  SlaveNodeTest() { corridor_ = station_.prepare(circle(1, 0.005)); }

  static ContourMessage circle(std::uint32_t id, double radius_m) {
    ContourMessage contour;
    contour.id = id;
    for (int i = 0; i < 400; ++i)
      contour.points_m.emplace_back(radius_m * std::cos(i * M_PI / 200), radius_m * std::sin(i * M_PI / 200));
    return contour;
  }

  Vec3 place(double t_s) const {
    const double angle = 0.02 / 0.005 * t_s;
    return {radius_m_ * std::cos(angle), radius_m_ * std::sin(angle), height_m_};
  }

  CommandBlock next_block() {
    CommandBlock block;
    block.sequence = ++number_;
    block.epoch = epoch_;
    block.sent_ns = now_ns_;
    block.first_tick = tick_;
    const double period_s = ticks_per_sample_ * 1e-3;
    block.sample_period_ns = 1'000'000U * ticks_per_sample_;
    block.ticks_per_sample = ticks_per_sample_;
    block.contour_id = contour_id_;
    block.engaged = engaged_;
    // What led before the slave began to listen counts for nothing.
    block.engage = block.epoch == known_epoch_ ? engage_ : engage_ - 1;
    known_epoch_ = block.epoch;
    block.echo_sequence = echo_.sequence;
    block.echo_sent_ns = echo_.sent_ns;
    block.engaged_before = engaged_ ? 0x7F : 0;
    const double t0 = static_cast<double>(tick_) * 1e-3;
    const double h = 1e-6;
    block.anchor = to_wire_precision(Anchor{place(t0), (place(t0 + h) - place(t0)) / h});
    std::vector<Vec3> samples;
    samples.reserve(16);
    for (int n = 0; n < 16; ++n) samples.push_back(place(t0 + n * period_s));
    std::uint64_t buttons = 0;
    for (Tick n = 0; n < 16; ++n) buttons |= std::uint64_t{pressed_(tick_ + n * ticks_per_sample_)} << n;
    if (released_blocks_ > 0) buttons = 0;
    released_blocks_ = std::max(released_blocks_ - 1, 0);
    const auto bytes =
        encoder_.encode(samples, buttons, {block.anchor.position_m, block.anchor.velocity_m_per_s * period_s},
                        block.payload.room());
    EXPECT_TRUE(bytes.has_value());
    block.payload.size = static_cast<std::uint16_t>(bytes.value_or(0));
    tick_ += Tick{16} * ticks_per_sample_;
    return block;
  }

  /// 16 ms of the slave; the block (if any) arrives at their beginning.
  void run(const std::optional<CommandBlock>& block) {
    for (int n = 0; n < 16; ++n) {
      std::vector<Received<CommandBlock>> arrived;
      if (n == 0 && block) arrived.push_back({*block, now_ns_});
      out_ = station_.step(now_ns_, corridor_.get(), arrived, stop_);
      if (out_.state) {
        states_.push_back(*out_.state);
        while (states_.size() > states_late_ + 1) states_.pop_front();
        echo_ = states_.front();
      }
      judge();
      now_ns_ += kMs;
      const Vec3 v = out_.reference.velocity_m_per_s;
      if (have_velocity_) largest_step_ = std::max(largest_step_, (v - last_velocity_).norm());
      last_velocity_ = v;
      have_velocity_ = true;
      if (out_.laser_w > 0.0) ++laser_ticks_;
    }
  }
  void judge() {
    const bool lit = out_.laser_w > 0.0;
    ASSERT_GE(out_.laser_w, 0.0);
    ASSERT_LE(out_.laser_w, 15.0);
    ASSERT_TRUE(!lit || out_.interlock == Interlock::kReady);
    ASSERT_TRUE(!lit || (out_.mode == SlaveMode::kFollowing && out_.applied_tick >= 0.0));
    if (each_tick_) each_tick_();
  }
  void follow(double seconds) {
    for (int b = 0; b < static_cast<int>(seconds / 0.016); ++b) run(next_block());
  }

  /// The operator lets the button go, engages anew and presses again.
  void engage_anew() {
    ++engage_;
    released_blocks_ = 8;
  }

  /// Some of the tests push it.
  static StationSettings touched() {
    StationSettings settings;
    settings.node.touched = true;
    return settings;
  }
  Station station_{touched()};
  std::unique_ptr<Corridor> corridor_;
  codec::BlockEncoder encoder_{codec::StreamSettings{}};
  std::uint32_t number_ = 0;
  std::uint32_t epoch_ = 7;
  std::uint32_t known_epoch_ = 0;
  std::uint32_t engage_ = 1;
  int released_blocks_ = 8;
  StopOrder stop_;
  StateHeader echo_;
  std::deque<StateHeader> states_;
  std::size_t states_late_ = 0;  ///< on their way to the master
  Tick tick_ = 0;
  std::uint16_t ticks_per_sample_ = 1;
  bool engaged_ = true;
  double radius_m_ = 0.005;
  double height_m_ = 0.0;
  std::uint32_t contour_id_ = 1;
  std::function<bool(Tick)> pressed_ = [](Tick) { return true; };
  std::function<void()> each_tick_;
  std::int64_t now_ns_ = 0;
  SlaveOutputs out_;
  Vec3 last_velocity_ = Vec3::Zero();
  bool have_velocity_ = false;
  double largest_step_ = 0.0;
  int laser_ticks_ = 0;
};

}  // namespace telekerf::slave
