// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "experiments/chaos/attackers.h"
#include "experiments/chaos/operator_script.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::experiments {
namespace {

constexpr double kLeastHealed_s = 7.0;
constexpr double kSilentLaser_s = 3e-3;
/// A process that has failed is begun anew after this.
constexpr std::int64_t kRespawn_ns = 1'000'000'000;
/// The lap goes on: it still cuts in the run's last second.
constexpr std::int64_t kLast_ns = 1'000'000'000;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::uint32_t kMasterEpoch = 100, kSecondEpoch = 1000, kSlaveEpoch = 2000;

std::int64_t ns(double s) noexcept { return std::llround(s * 1e9); }

struct Saying {
  std::int64_t said_ns;
  std::int64_t due_ns;
  EventMessage event;
};

class World {
 public:
  World(const ChaosSettings& settings, const ChaosContours& contours)
      : settings_(settings),
        contours_(contours),
        heal_s_(heal_s(settings.duration_s, settings.mode)),
        schedule_(draw_schedule(settings.seed, settings.kinds, heal_s_)),
        begun_(schedule_.windows.size(), false),
        done_(schedule_.windows.size(), false),
        forward_(link_profile(schedule_, true), settings.seed, netem::Direction::kForward),
        backward_(link_profile(schedule_, false), settings.seed, netem::Direction::kBackward),
        second_forward_(link_profile(schedule_, true), settings.seed + 1, netem::Direction::kForward),
        second_backward_(link_profile(schedule_, false), settings.seed + 1, netem::Direction::kBackward),
        master_(station(settings.master, settings.seed), pressed_),
        slave_(station(settings.slave, settings.seed)),
        script_(settings.seed, settings.mode == ChaosMode::kLiveness ? heal_s_ : 1e9),
        forger_(settings.master.validated().node.command.codec),
        checker_(slave_.model(), settings.bars) {
    publish_truth(contours.work);
    master_.start(master_epoch_, *contour_, refused_);
    slave_.start(slave_epoch_, *contour_, refused_);
    master_.time.next_ns = slave_.time.next_ns = 0;
  }

  ChaosOutcome run() {
    const std::int64_t end_ns = ns(settings_.duration_s);
    std::int64_t now_ns = 0;
    std::optional<double> inside_j;
    while (true) {
      now_ns = std::min(master_.time.next_ns, slave_.time.next_ns);
      if (second_) now_ns = std::min(now_ns, second_->time.next_ns);
      if (now_ns >= end_ns) break;
      turn(now_ns);
      if (master_.time.next_ns <= now_ns) step_master(now_ns);
      if (second_ && second_->time.next_ns <= now_ns) step_second(now_ns);
      if (slave_.time.next_ns <= now_ns) step_slave(now_ns);
      if (!inside_j && now_ns >= end_ns - kLast_ns) inside_j = checker_.findings().energy_inside_j;
    }
    ChaosOutcome out;
    out.recovered = checker_.findings().energy_inside_j > inside_j.value_or(0.0);
    if (settings_.mode == ChaosMode::kLiveness && !out.recovered) checker_.not_recovered(end_ns);
    if (second_) second_->end(refused_);
    master_.end(refused_);
    slave_.end(refused_);
    const std::uint64_t damaged = forward_.counters().corrupted + backward_.counters().corrupted;
    if (damaged > 0) refused_["datagram: its checksum does not fit"] = damaged;
    out.findings = checker_.findings();
    out.refused = refused_;
    out.engages = script_.engages();
    return out;
  }

 private:
  template <class StationSettings>
  static StationSettings station(StationSettings settings, std::uint64_t seed) {
    settings.seed = seed;
    settings.record_s = 0.01;
    return settings;
  }

  /// Windows that begin or end, and processes that are due again.
  void turn(std::int64_t now_ns) {
    const double now_s = static_cast<double>(now_ns) * 1e-9;
    for (std::size_t i = 0; i < begun_.size(); ++i) {
      const FaultWindow& window = schedule_.windows[i];
      if (!begun_[i] && window.from_s <= now_s) {
        begun_[i] = true;
        begin(now_ns, window);
      }
      if (begun_[i] && !done_[i] && window.to_s <= now_s) {
        done_[i] = true;
        finish(now_ns, window);
      }
    }
    if (settings_.mode == ChaosMode::kLiveness && !healed_ && now_s >= heal_s_) heal(now_ns);
    if (master_again_ns_ <= now_ns) begin_master(now_ns);
    if (slave_again_ns_ <= now_ns) begin_slave(now_ns);
    if (impostor_at_master_ns_ <= now_ns || contour_at_master_ns_ <= now_ns) {
      const bool impostor = impostor_at_master_ns_ <= now_ns;
      (impostor ? impostor_at_master_ns_ : contour_at_master_ns_) = kNever;
      if (master_.running()) master_.publish(impostor ? contours_.impostor : *contour_, refused_);
    }
  }

  void begin(std::int64_t now_ns, const FaultWindow& window) {
    const double sign = (window.word & 2U) != 0 ? 1.0 : -1.0;
    switch (window.kind) {
      case FaultKind::kSlaveClock:
      case FaultKind::kMasterClock: {
        SiteTime& site = window.kind == FaultKind::kSlaveClock ? slave_.time : master_.time;
        const double jump_s = (window.word & 1U) != 0 ? 0.02 + 2.0 * window.strength : 0.0;
        site.clock.change(now_ns, 1.0 + 1e-3 * sign * window.strength, jump_s);
        break;
      }
      case FaultKind::kOutage:
      case FaultKind::kOutageForward:
        ++clogged_;
        break;
      case FaultKind::kSlaveAsleep:
        if (slave_.running() && sleeping_slave_ == 0) checker_.afterglow(truth(now_ns), kSilentLaser_s);
        slave_.time.asleep = ++sleeping_slave_ > 0;
        break;
      case FaultKind::kMasterAsleep:
        master_.time.asleep = ++sleeping_master_ > 0;
        break;
      case FaultKind::kSlaveRestart:
        end_slave(now_ns, ns(window.to_s));
        break;
      case FaultKind::kMasterRestart:
        end_master(ns(window.to_s));
        break;
      case FaultKind::kContour:
        publish_truth(contour_ == &contours_.work ? contours_.other : contours_.work);
        if (slave_.running() && slave_.publish(*contour_, refused_)) checker_.off_is_due();
        checker_.needs_restart(now_ns);
        contour_at_master_ns_ = now_ns + ns(0.5 * schedule_.rtt_s);
        break;
      case FaultKind::kImpostor:
        if (contour_ != &contours_.work) break;
        impostor_ = slave_.running() && slave_.publish(contours_.impostor, refused_);
        impostor_at_master_ns_ = now_ns + ns(0.5 * schedule_.rtt_s);
        break;
      case FaultKind::kBeta:
        say(now_ns, scale_event(0.35 + 0.65 * window.strength));
        break;
      case FaultKind::kStop:
        say(now_ns, stop_event());
        break;
      case FaultKind::kSensorDropout:
        slave_.sensor.dropout = true;
        break;
      case FaultKind::kSensorStuck:
        slave_.sensor.stuck = true;
        break;
      case FaultKind::kSensorSlip:
        slave_.sensor.slip_m[static_cast<int>(window.word % 3)] += sign * (2e-5 + 5.8e-4 * window.strength);
        break;
      case FaultKind::kLaserDeaf:
        slave_.laser.deaf = true;
        break;
      case FaultKind::kLaserStuck:
        slave_.laser.stuck = true;
        break;
      case FaultKind::kSecondMaster:
        begin_second(now_ns);
        break;
      default:
        break;
    }
  }

  void finish(std::int64_t now_ns, const FaultWindow& window) {
    switch (window.kind) {
      case FaultKind::kSlaveClock:
        slave_.time.clock.change(now_ns, 1.0, 0.0);
        break;
      case FaultKind::kMasterClock:
        master_.time.clock.change(now_ns, 1.0, 0.0);
        break;
      case FaultKind::kOutage:
      case FaultKind::kOutageForward:
        --clogged_;
        break;
      case FaultKind::kSlaveAsleep:
        if (slave_.time.asleep = --sleeping_slave_ > 0; !slave_.time.asleep) wake(now_ns, slave_.time);
        checker_.interrupted();
        if (window.to_s - window.from_s > settings_.bars.gate_s) checker_.needs_restart(ns(window.from_s));
        break;
      case FaultKind::kMasterAsleep:
        if (master_.time.asleep = --sleeping_master_ > 0; !master_.time.asleep) wake(now_ns, master_.time);
        break;
      case FaultKind::kStop:
        say(now_ns, clear_event());
        break;
      case FaultKind::kSensorDropout:
        slave_.sensor.dropout = false;
        break;
      case FaultKind::kSensorStuck:
        slave_.sensor.stuck = false;
        break;
      case FaultKind::kLaserDeaf:
        slave_.laser.deaf = false;
        break;
      case FaultKind::kLaserStuck:
        slave_.laser.stuck = false;
        break;
      case FaultKind::kSecondMaster:
        if (second_) second_->end(refused_);
        second_.reset();
        break;
      default:
        break;
    }
  }

  static void wake(std::int64_t now_ns, SiteTime& site) { site.awake_since_ns = now_ns; }

  void heal(std::int64_t now_ns) {
    healed_ = true;
    if (!slave_.sensor.slip_m.isZero()) end_slave(now_ns, now_ns);  // homed anew
    if (impostor_) {  // vision's own stands again
      if (slave_.running()) (void)slave_.publish(*contour_, refused_);
      contour_at_master_ns_ = now_ns;
    }
  }

  void publish_truth(const ContourMessage& contour) {
    contour_ = &contour;
    corridor_ = std::make_unique<geometry::NearestIndex>(geometry::Polyline{contour.points_m, contour.closed});
    checker_.contour(corridor_.get());
  }

  void end_master(std::int64_t again_ns) {
    master_.end(refused_);
    master_again_ns_ = std::min(master_again_ns_, again_ns);
  }
  void begin_master(std::int64_t now_ns) {
    master_again_ns_ = kNever;
    states_.clear();
    backward_.deliver(now_ns, states_);  // nobody was there for it
    master_.start(++master_epoch_, *contour_, refused_);
    master_began_ns_ = now_ns;
    shown_.reset();
  }
  void end_slave(std::int64_t now_ns, std::int64_t again_ns) {
    slave_.end(refused_);
    slave_ended_ns_ = now_ns;
    slave_again_ns_ = std::min(slave_again_ns_, again_ns);
  }
  void begin_slave(std::int64_t now_ns) {
    slave_again_ns_ = kNever;
    arrived_.clear();
    forward_.deliver(now_ns, arrived_);
    std::erase_if(to_slave_, [&](const Saying& saying) { return saying.due_ns <= now_ns; });
    slave_.start(++slave_epoch_, *contour_, refused_);
    checker_.interrupted();
    checker_.needs_restart(slave_ended_ns_);
  }
  void begin_second(std::int64_t now_ns) {
    if (second_) return;
    auto settings = station(settings_.master, settings_.seed + 7);
    second_ = std::make_unique<MasterSite>(settings, second_pressed_);
    second_->start(++second_epoch_, *contour_, refused_);
    second_->time.next_ns = now_ns;
    second_engaged_ = false;
  }

  /// Reliable: at the operator's site at once, at the slave after the way there and an outage.
  void say(std::int64_t now_ns, const EventMessage& event) {
    if (master_.running()) to_master_.push_back(event);
    to_slave_.push_back({now_ns, now_ns + ns(0.5 * schedule_.rtt_s), event});
  }

  void step_master(std::int64_t now_ns) {
    SiteTime& time = master_.time;
    time.next_ns += time.period_ns();
    if (!master_.running() || time.asleep) return;
    take(backward_, now_ns, time, states_);
    if (!states_.empty()) {
      shown_ = states_.back().value;
      shown_ns_ = now_ns;
    }
    births_.made(master_.epoch(), master_.tick(), now_ns);
    events_.swap(to_master_);
    to_master_.clear();
    const auto out = master_.step(time.clock.local(now_ns), states_, events_, refused_);
    if (out.command) send(now_ns, *out.command, forward_);
    said_.clear();
    script_.step({now_ns, out.mode, shown_ ? &*shown_ : nullptr, shown_ns_}, said_);
    for (const EventMessage& event : said_) {
      if (event.kind == EventMessage::Kind::kEngage) checker_.engaged(now_ns);
      say(now_ns, event);
    }
    pressed_ = script_.pressed() && !bounced(now_ns);
    checker_.button(now_ns, pressed_);
    if (master_.failed()) end_master(now_ns + kRespawn_ns);
  }

  void step_second(std::int64_t now_ns) {
    second_->time.next_ns += second_->time.period_ns();
    take(second_backward_, now_ns, second_->time, states_);
    births_.made(second_->epoch(), second_->tick(), now_ns);
    events_.clear();
    if (second_ready_ && !second_engaged_) {
      events_.push_back(engage_event());
      checker_.engaged(now_ns);
      second_engaged_ = true;
    }
    const auto out = second_->step(second_->time.clock.local(now_ns), states_, events_, refused_);
    second_ready_ = out.mode == master::MasterMode::kGuiding;
    if (out.command) send(now_ns, *out.command, second_forward_);
  }

  void step_slave(std::int64_t now_ns) {
    SiteTime& time = slave_.time;
    time.next_ns += time.period_ns();
    attack(now_ns);
    if (!slave_.running() || time.asleep) return;
    commands_.clear();
    receive(now_ns, forward_);
    if (second_) receive(now_ns, second_forward_);
    for (const Datagram& datagram : injected_)
      commands_.push_back({datagram.block, time.stamp(now_ns)});
    injected_.clear();
    events_.clear();
    while (!to_slave_.empty() && to_slave_.front().due_ns <= now_ns && clogged_ == 0) hear();

    const slave::SlaveOutputs out = slave_.step(time.clock.local(now_ns), commands_, events_);
    if (out.state) {
      followed_epoch_ = out.state->master_epoch;
      backward_.push(now_ns, *out.state, wire_bytes(*out.state));
      if (second_) second_backward_.push(now_ns, *out.state, wire_bytes(*out.state));
    }
    Observation seen = truth(now_ns);
    seen.reference = out.reference;
    seen.permitted = out.interlock == Interlock::kReady && out.laser_w > 0.0;
    if (out.applied_tick >= 0.0) {
      const auto born = births_.of(followed_epoch_, static_cast<Tick>(out.applied_tick));
      if (born) seen.age_s = static_cast<double>(now_ns - *born) * 1e-9;
    }
    checker_.observe(seen);
    if (slave_.failed()) end_slave(now_ns, now_ns + kRespawn_ns);
  }

  Observation truth(std::int64_t now_ns) const {
    Observation seen{.now_ns = now_ns, .period_s = static_cast<double>(slave_.time.period_ns()) * 1e-9};
    seen.tool_m = slave_.tool_m();
    seen.velocity_m_per_s = slave_.velocity_m_per_s();
    seen.told_w = slave_.laser.told_w;
    seen.emitted_w = slave_.laser.emitted_w;
    seen.stuck = slave_.laser.stuck || slave_.laser.deaf;
    return seen;
  }

  void hear() {
    const Saying& saying = to_slave_.front();
    events_.push_back(saying.event);
    const bool stop = saying.event.kind == EventMessage::Kind::kStop;
    if (stop) checker_.off_is_due();
    if (stop || saying.event.kind == EventMessage::Kind::kClearStop) checker_.needs_restart(saying.said_ns);
    to_slave_.erase(to_slave_.begin());
  }

  void send(std::int64_t now_ns, const CommandBlock& block, simulation::VirtualLink<Datagram>& link) {
    link.push(now_ns, Datagram{.block = block, .genuine = true, .born_ns = now_ns}, wire_bytes(block));
    if (&link != &forward_) return;
    forger_.saw(block);
    if (keeps_tape()) replayer_.saw(now_ns, block);
  }
  bool keeps_tape() const {
    return std::find(schedule_.kinds.begin(), schedule_.kinds.end(), FaultKind::kReplayer) != schedule_.kinds.end();
  }

  void attack(std::int64_t now_ns) {
    for (std::size_t i = 0; i < begun_.size(); ++i) {
      if (!begun_[i] || done_[i]) continue;
      const FaultWindow& window = schedule_.windows[i];
      if (window.kind == FaultKind::kForger) forger_.step(now_ns, window, births_, injected_);
      if (window.kind == FaultKind::kReplayer) replayer_.step(now_ns, window, births_, injected_);
    }
    if (!slave_.running()) injected_.clear();
  }

  void receive(std::int64_t now_ns, simulation::VirtualLink<Datagram>& link) {
    arrived_.clear();
    link.deliver(now_ns, arrived_);
    for (const auto& [datagram, due_ns] : arrived_) {
      if (datagram.block.epoch == master_epoch_) checker_.needs_restart(master_began_ns_);
      checker_.heard(now_ns, datagram.born_ns);
      commands_.push_back({datagram.block, slave_.time.stamp(due_ns)});
    }
  }

  template <class T>
  static void take(simulation::VirtualLink<T>& link, std::int64_t now_ns, const SiteTime& time,
                   std::vector<Received<T>>& out) {
    out.clear();
    link.deliver(now_ns, out);
    for (Received<T>& one : out) one.received_ns = time.stamp(one.received_ns);
  }

  /// The button's contact is open although it is pressed.
  bool bounced(std::int64_t now_ns) const {
    for (std::size_t i = 0; i < begun_.size(); ++i) {
      const FaultWindow& window = schedule_.windows[i];
      if (window.kind != FaultKind::kChatter || !begun_[i] || done_[i]) continue;
      const auto slot = static_cast<std::uint64_t>(now_ns / 7'000'000);
      return (netem::mixed(slot ^ window.word) & 1U) != 0;
    }
    return false;
  }

  const ChaosSettings& settings_;
  const ChaosContours& contours_;
  double heal_s_;
  Schedule schedule_;
  std::vector<bool> begun_, done_;
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
  std::uint32_t master_epoch_ = kMasterEpoch, second_epoch_ = kSecondEpoch, slave_epoch_ = kSlaveEpoch;
  std::uint32_t followed_epoch_ = 0;
  int clogged_ = 0, sleeping_slave_ = 0, sleeping_master_ = 0;
  bool healed_ = false, impostor_ = false, second_engaged_ = false, second_ready_ = false;
  std::int64_t master_again_ns_ = kNever, slave_again_ns_ = kNever, slave_ended_ns_ = 0, master_began_ns_ = 0;
  std::int64_t contour_at_master_ns_ = kNever, impostor_at_master_ns_ = kNever;
  std::optional<StateHeader> shown_;
  std::int64_t shown_ns_ = 0;
  std::vector<EventMessage> to_master_, events_, said_;
  std::vector<Saying> to_slave_;
  std::vector<Datagram> injected_;
  std::vector<Received<Datagram>> arrived_;
  std::vector<Received<CommandBlock>> commands_;
  std::vector<Received<StateBlock>> states_;
};

}  // namespace

ChaosContours chaos_contours(const master::StationSettings& master, const slave::StationSettings& slave) {
  simulation::SimulationSettings settings;
  settings.master = master;
  settings.slave = slave;
  ChaosContours contours;
  contours.work = simulation::find_contour(settings);
  settings.image = "blob";
  contours.other = simulation::find_contour(settings);
  contours.impostor = contours.other;
  contours.impostor.id = contours.work.id;
  return contours;
}

double heal_s(double duration_s, ChaosMode mode) noexcept {
  if (mode == ChaosMode::kSafety) return duration_s;
  return std::max(0.0, duration_s - std::max(duration_s / 3.0, kLeastHealed_s));
}

ChaosOutcome run_chaos(const ChaosSettings& settings, const ChaosContours& contours) {
  return World(settings, contours).run();
}

}  // namespace telekerf::experiments
