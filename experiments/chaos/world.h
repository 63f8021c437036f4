// SPDX-License-Identifier: Apache-2.0
// Both sites, the network between them, the operator, attackers and the checker, in one thread and in virtual
// time. What goes wrong is done to it from outside: see injection.h.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "experiments/chaos/attackers.h"
#include "experiments/chaos/chaos_run.h"
#include "experiments/chaos/operator_script.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::experiments {

/// True time of what is not going to happen.
inline constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();
/// Seconds in nanoseconds.
std::int64_t ns(double s) noexcept;

class World {
 public:
  World(const ChaosSettings& settings, const ChaosContours& contours, const Schedule& schedule);

  /// True time of the next step of anybody.
  std::int64_t next_ns() const noexcept;
  /// Everybody who is due at `now_ns` makes a step. `attacks`: windows of attackers that hold.
  void step(std::int64_t now_ns, const std::vector<FaultWindow>& attacks);
  /// Ends the processes, for their counters.
  ChaosOutcome end();

  /// The processes; again at `again_ns`, with nothing known but the contour.
  void end_master(std::int64_t again_ns);
  void end_slave(std::int64_t now_ns, std::int64_t again_ns);
  void begin_second(std::int64_t now_ns);
  void end_second();
  /// As by SIGSTOP and SIGCONT; what overlaps is counted.
  void put_to_sleep(bool slave, std::int64_t now_ns);
  void wake(bool slave, std::int64_t now_ns, std::int64_t since_ns);
  /// The line of events to the slave waits.
  void clog(int more) noexcept { clogged_ += more; }
  /// Vision publishes the other of the two contours, or a wrong one under a known id.
  void swap_contour(std::int64_t now_ns);
  void publish_impostor(std::int64_t now_ns);
  /// Reliable, and heard at the operator's site alone.
  void say(const EventMessage& event);
  /// Somebody says stop, or that all stops are over: at the operator's site at once, at the slave later.
  void say_stop(std::int64_t now_ns, bool set);
  /// The button's contact is open although it is pressed.
  void bounce(bool open) noexcept { bounced_ = open; }
  /// Sensors are homed, and vision's own contour stands again.
  void heal(std::int64_t now_ns);

  MasterSite& master() noexcept { return master_; }
  SlaveSite& slave() noexcept { return slave_; }
  Checker& checker() noexcept { return checker_; }

 private:
  struct Saying {
    std::int64_t said_ns;
    std::int64_t due_ns;
    StopMessage stop;
  };

  void publish_truth(const ContourMessage& contour);
  void begin_again(std::int64_t now_ns);
  void begin_master(std::int64_t now_ns);
  void begin_slave(std::int64_t now_ns);
  void step_master(std::int64_t now_ns);
  void step_second(std::int64_t now_ns);
  void step_slave(std::int64_t now_ns, const std::vector<FaultWindow>& attacks);
  void hear_stops(std::int64_t now_ns);
  Observation truth(std::int64_t now_ns) const;
  void send(std::int64_t now_ns, const CommandBlock& block, simulation::VirtualLink<Datagram>& link);
  void attack(std::int64_t now_ns, const std::vector<FaultWindow>& attacks);
  void receive(std::int64_t now_ns, simulation::VirtualLink<Datagram>& link);

  const ChaosSettings& settings_;
  const ChaosContours& contours_;
  const Schedule& schedule_;
  WireCost<CommandBlock> command_cost_;
  simulation::VirtualLink<Datagram> forward_;
  simulation::VirtualLink<StateBlock> backward_;
  simulation::VirtualLink<Datagram> second_forward_;
  simulation::VirtualLink<StateBlock> second_backward_;
  bool pressed_ = false;
  bool second_pressed_ = true;
  MasterSite master_;
  SlaveSite slave_;
  std::unique_ptr<MasterSite> second_;
  OperatorScript script_;
  Forger forger_;
  Replayer replayer_;
  BirthRegister births_;
  Checker checker_;
  Refused refused_;

  const ContourMessage* contour_ = nullptr;  ///< in force, in truth
  std::unique_ptr<geometry::NearestIndex> corridor_;
  std::uint32_t master_epoch_ = 100, second_epoch_ = 1000, slave_epoch_ = 2000;
  std::uint32_t followed_epoch_ = 0;
  int clogged_ = 0, sleeping_slave_ = 0, sleeping_master_ = 0;
  bool bounced_ = false, impostor_ = false, second_engaged_ = false, second_ready_ = false;
  std::int64_t master_again_ns_ = kNever_ns, slave_again_ns_ = kNever_ns, slave_ended_ns_ = 0,
               master_began_ns_ = 0;
  std::int64_t contour_at_master_ns_ = kNever_ns, impostor_at_master_ns_ = kNever_ns;
  std::optional<StateHeader> shown_;
  std::int64_t shown_ns_ = 0;
  std::vector<EventMessage> to_master_, events_;
  Said said_;
  std::vector<std::uint32_t> stops_;  ///< said, and not yet over
  std::uint32_t stop_number_ = 0;
  std::vector<Saying> to_slave_;
  std::vector<Datagram> injected_;
  std::vector<Received<Datagram>> arrived_;
  std::vector<Received<CommandBlock>> commands_;
  std::vector<Received<StateBlock>> states_;
};

}  // namespace telekerf::experiments
