// SPDX-License-Identifier: Apache-2.0
// What the bus tells of the cell, gathered for the page: the newest of everything, in the contour's frame.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/protocol/messages.h"
#include "common/protocol/overhead.h"
#include "common/streaming/state_receiver.h"
#include "master/console/cut_memory.h"
#include "master/console/depth_plan.h"
#include "master/console/mark_trail.h"
#include "master/console/page_protocol.h"
#include "master/operator/udp_hand.h"
#include "master/stream_choice.h"

namespace telekerf::master {

/// Pure: time is what it is told, this machine's monotonic clock.
class CellView {
 public:
  /// Numbers older than this are not the cell's state any more.
  static constexpr double kStale_s = 0.5;

  explicit CellView(const CutPower& cut = {}) { depths_.set_power(cut.power); }

  void hear(const Received<CommandBlock>& command);
  void hear(const Received<StateBlock>& state);
  void hear(const TelemetryMessage& telemetry, std::int64_t now_ns);
  void hear(ContourMessage contour);
  void hear(PreviewMessage preview);
  /// The master's own answer to the hand, between two of its telemetries.
  void hear(const UdpHandAnswer& answer) noexcept;

  /// All but what the console itself knows of the hand.
  PageFields fields(std::int64_t now_ns);
  /// One sentence: what holds, or what hinders. `stop`: why everything is stopped; empty: it is not.
  std::string sentence(const std::string& stop, std::int64_t now_ns) const;
  /// And of the beam. `armed`: the fire button counts.
  std::string beam_sentence(bool armed, std::int64_t now_ns) const;

  /// What the cell works on, as far as the console has seen it.
  const std::optional<ContourMessage>& contour() const noexcept { return contour_; }
  /// That waits for somebody to take it; null: none.
  const ContourMessage* waiting() const noexcept { return waiting_ ? &*waiting_ : nullptr; }
  /// One of the two; null: neither has this id.
  const ContourMessage* contour(std::uint32_t id) const noexcept;
  struct Picture {
    std::uint64_t number = 0;  ///< of all that have come
    PreviewMessage preview;
  };
  /// The newest picture by the contour in whose frame it lies; 0: nothing has been found in it.
  const std::map<std::uint32_t, Picture>& pictures() const noexcept { return pictures_; }
  /// Of vision's imaging unit; empty: there is none.
  std::string imaging_sentence(std::int64_t now_ns) const;
  double zoom() const;  ///< share of the axis' travel
  /// Threshold in force for the picture, a share; 0: found by itself; none: vision has not said.
  std::optional<double> level() const;
  MarkTrail& mark() noexcept { return mark_; }
  const DepthTrail& depths() const noexcept { return depths_; }
  /// What who drives has said of the work.
  const DepthWish& wish() const noexcept { return wish_; }
  void set_material(const workpiece::Material& material) noexcept { wish_.material = &material, ++wish_version_; }
  void set_depth(double depth_m) noexcept { wish_.depth_m = depth_m, ++wish_version_; }
  /// Counts what has changed of the wish, and of the depths.
  std::uint64_t depths_version() const noexcept { return depths_.version() + wish_version_; }
  /// What an earlier console has seen cut, and was told: it counts if the cell still is at that work.
  void remember(CutSoFar before) { before_ = std::move(before); }
  /// None: nobody knows yet which work it is, or nothing has changed since it was asked for last.
  std::optional<CutSoFar> news_of_cut();
  bool laser_on(std::int64_t now_ns) const noexcept { return slave_fresh(now_ns) && slave_.laser_on; }
  bool engaged(std::int64_t now_ns) const;
  double beta() const { return value("beta", 1.0); }
  /// Law, estimator and codec as the master has told them; none: it has not.
  std::optional<StreamChoice> stream() const;
  bool master_fresh(std::int64_t now_ns) const noexcept;
  bool slave_fresh(std::int64_t now_ns) const noexcept;

 private:
  /// Bytes of one direction: of the last full second, and so far.
  struct Rate {
    void add(std::uint32_t bytes, std::int64_t now_ns) noexcept;
    double per_s(std::int64_t now_ns) noexcept;
    std::int64_t since_ns = 0;
    double bytes = 0.0;
    double last = 0.0;
  };
  /// What the master was at one of its ticks.
  struct MasterMoment {
    std::int64_t tick = -1;
    Vec2 scaled_m = Vec2::Zero();
    Vec2 predicted_m = Vec2::Zero();
  };

  double value(const char* name, double otherwise = 0.0) const;
  /// Somebody works on the contour with this id.
  void works_on(std::uint32_t id);
  void forget_pictures();
  void begin_depths() { depths_.begin({contour_->points_m, contour_->closed}); }
  void compare(const streaming::SlaveSample& sample) noexcept;
  void recall();

  std::map<std::string, double, std::less<>> master_;  ///< telemetry
  std::int64_t master_ns_ = 0;
  bool master_heard_ = false;
  std::array<MasterMoment, 256> moments_{};
  int command_ticks_ = 1;  ///< control steps a sample of the command stream
  std::unique_ptr<streaming::StateReceiver> states_;
  std::uint32_t states_epoch_ = 0;  ///< of the master that states_ is of
  StateHeader slave_;
  std::int64_t slave_ns_ = 0;
  bool slave_heard_ = false;
  Vec2 slave_m_ = Vec2::Zero();
  double slave_speed_m_per_s_ = 0.0;
  double tracking_m_ = 0.0;
  double prediction_m_ = 0.0;
  double round_trip_s_ = 0.0;
  Rate commands_, states_rate_;
  WireCost<CommandBlock> command_cost_;
  WireCost<StateBlock> state_cost_;
  std::optional<ContourMessage> contour_;
  std::optional<ContourMessage> waiting_;
  bool worked_on_ = false;  ///< the cell has been seen at work on `contour_`
  std::map<std::uint32_t, Picture> pictures_;
  std::uint64_t picture_count_ = 0;
  std::map<std::string, double, std::less<>> vision_;  ///< telemetry
  std::int64_t vision_ns_ = 0;
  std::optional<UdpHandAnswer> answer_;  ///< newer than the telemetry
  MarkTrail mark_;
  DepthTrail depths_;
  DepthWish wish_;
  std::uint64_t wish_version_ = 0;
  std::optional<CutSoFar> before_;
  std::uint64_t cut_told_ = 0;  ///< counts what has changed, at the last telling
};

}  // namespace telekerf::master
