// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/world.h"

#include <algorithm>
#include <cmath>

namespace telekerf::experiments {
namespace {

constexpr double kSilentLaser_s = 3e-3;
/// A process that has failed is begun anew after this.
constexpr std::int64_t kRespawn_ns = 1'000'000'000;

template <class StationSettings>
StationSettings seeded(StationSettings settings, std::uint64_t seed) {
  settings.seed = seed;
  settings.record_s = 0.01;
  return settings;
}

template <class T>
void take(simulation::VirtualLink<T>& link, std::int64_t now_ns, const SiteTime& time,
          std::vector<Received<T>>& out) {
  out.clear();
  link.deliver(now_ns, out);
  for (Received<T>& one : out) one.received_ns = time.stamp(one.received_ns);
}

}  // namespace

std::int64_t ns(double s) noexcept { return std::llround(s * 1e9); }

World::World(const ChaosSettings& settings, const ChaosContours& contours, const Schedule& schedule)
    : settings_(settings),
      contours_(contours),
      schedule_(schedule),
      forward_(link_profile(schedule, true), settings.seed, netem::Direction::kForward),
      backward_(link_profile(schedule, false), settings.seed, netem::Direction::kBackward),
      second_forward_(link_profile(schedule, true), settings.seed + 1, netem::Direction::kForward),
      second_backward_(link_profile(schedule, false), settings.seed + 1, netem::Direction::kBackward),
      master_(seeded(settings.master, settings.seed), pressed_),
      slave_(seeded(settings.slave, settings.seed)),
      script_(settings.seed,
              settings.mode == ChaosMode::kLiveness ? heal_s(settings.duration_s, settings.mode) : 1e9),
      forger_(settings.master.validated().node.command.codec),
      checker_(slave_.model(), settings.bars) {
  publish_truth(contours.work);
  master_.start(master_epoch_, *contour_, refused_);
  slave_.start(slave_epoch_, *contour_, refused_);
}

std::int64_t World::next_ns() const noexcept {
  const std::int64_t next = std::min(master_.time.next_ns, slave_.time.next_ns);
  return second_ ? std::min(next, second_->time.next_ns) : next;
}

void World::step(std::int64_t now_ns, const std::vector<FaultWindow>& attacks) {
  begin_again(now_ns);
  if (master_.time.next_ns <= now_ns) step_master(now_ns);
  if (second_ && second_->time.next_ns <= now_ns) step_second(now_ns);
  if (slave_.time.next_ns <= now_ns) step_slave(now_ns, attacks);
}

ChaosOutcome World::end() {
  ChaosOutcome out;
  end_second();
  master_.end(refused_);
  slave_.end(refused_);
  const std::uint64_t damaged = forward_.counters().corrupted + backward_.counters().corrupted;
  if (damaged > 0) refused_["datagram: its checksum does not fit"] = damaged;
  out.findings = checker_.findings();
  out.refused = refused_;
  out.engages = script_.engages();
  return out;
}

void World::publish_truth(const ContourMessage& contour) {
  contour_ = &contour;
  corridor_ = std::make_unique<geometry::NearestIndex>(geometry::Polyline{contour.points_m, contour.closed});
  checker_.contour(corridor_.get());
}

void World::swap_contour(std::int64_t now_ns) {
  publish_truth(contour_ == &contours_.work ? contours_.other : contours_.work);
  if (slave_.running() && slave_.publish(*contour_, refused_)) checker_.off_is_due();
  checker_.needs_restart(now_ns);
  contour_at_master_ns_ = now_ns + ns(0.5 * schedule_.rtt_s);
}

void World::publish_impostor(std::int64_t now_ns) {
  if (contour_ != &contours_.work) return;
  impostor_ = slave_.running() && slave_.publish(contours_.impostor, refused_);
  impostor_at_master_ns_ = now_ns + ns(0.5 * schedule_.rtt_s);
}

void World::heal(std::int64_t now_ns) {
  if (!slave_.sensor.slip_m.isZero()) end_slave(now_ns, now_ns);
  if (!impostor_) return;
  if (slave_.running()) (void)slave_.publish(*contour_, refused_);
  contour_at_master_ns_ = now_ns;
}

void World::put_to_sleep(bool slave, std::int64_t now_ns) {
  if (slave && slave_.running() && sleeping_slave_ == 0) checker_.afterglow(truth(now_ns), kSilentLaser_s);
  ++(slave ? sleeping_slave_ : sleeping_master_);
  (slave ? slave_.time : master_.time).asleep = true;
}

void World::wake(bool slave, std::int64_t now_ns, std::int64_t since_ns) {
  SiteTime& time = slave ? slave_.time : master_.time;
  time.asleep = --(slave ? sleeping_slave_ : sleeping_master_) > 0;
  if (time.asleep) return;
  time.awake_since_ns = now_ns;
  if (!slave) return;
  checker_.interrupted();
  if (static_cast<double>(now_ns - since_ns) * 1e-9 > settings_.bars.gate_s) checker_.needs_restart(since_ns);
}

void World::end_master(std::int64_t again_ns) {
  master_.end(refused_);
  master_again_ns_ = std::min(master_again_ns_, again_ns);
}

void World::end_slave(std::int64_t now_ns, std::int64_t again_ns) {
  slave_.end(refused_);
  slave_ended_ns_ = now_ns;
  slave_again_ns_ = std::min(slave_again_ns_, again_ns);
}

void World::begin_again(std::int64_t now_ns) {
  if (master_again_ns_ <= now_ns) begin_master(now_ns);
  if (slave_again_ns_ <= now_ns) begin_slave(now_ns);
  for (std::int64_t* due_ns : {&impostor_at_master_ns_, &contour_at_master_ns_}) {
    if (*due_ns > now_ns) continue;
    *due_ns = kNever_ns;
    const ContourMessage& contour = due_ns == &impostor_at_master_ns_ ? contours_.impostor : *contour_;
    if (master_.running()) master_.publish(contour, refused_);
  }
}

void World::begin_master(std::int64_t now_ns) {
  master_again_ns_ = kNever_ns;
  states_.clear();
  backward_.deliver(now_ns, states_);  // nobody was there for it
  master_.start(++master_epoch_, *contour_, refused_);
  master_began_ns_ = now_ns;
  shown_.reset();
}

void World::begin_slave(std::int64_t now_ns) {
  slave_again_ns_ = kNever_ns;
  arrived_.clear();
  forward_.deliver(now_ns, arrived_);
  slave_.start(++slave_epoch_, *contour_, refused_);
  checker_.interrupted();
  checker_.needs_restart(slave_ended_ns_);
}

void World::begin_second(std::int64_t now_ns) {
  if (second_) return;
  second_ = std::make_unique<MasterSite>(seeded(settings_.master, settings_.seed + 7), second_pressed_);
  second_->start(++second_epoch_, *contour_, refused_);
  second_->time.next_ns = now_ns;
  second_ready_ = second_engaged_ = false;
}

void World::end_second() {
  if (second_) second_->end(refused_);
  second_.reset();
}

void World::say(const EventMessage& event) {
  if (master_.running()) to_master_.push_back(event);
}

void World::say_stop(std::int64_t now_ns, bool set) {
  if (set) stops_.push_back(++stop_number_);
  for (const std::uint32_t number : stops_) {
    StopMessage stop;
    stop.number = number;
    stop.source = "operator";
    stop.set = set;
    master_.hear(stop);
    to_slave_.push_back({now_ns, now_ns + ns(0.5 * schedule_.rtt_s), std::move(stop)});
  }
  if (!set) stops_.clear();
}

void World::step_master(std::int64_t now_ns) {
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
  said_.events.clear();
  said_.clear = false;
  script_.step({now_ns, out.mode, shown_ ? &*shown_ : nullptr, shown_ns_}, said_);
  if (said_.clear) say_stop(now_ns, false);
  for (const EventMessage& event : said_.events) {
    if (event.kind == EventMessage::Kind::kEngage) checker_.engaged(now_ns);
    say(event);
  }
  pressed_ = script_.pressed() && !bounced_;
  checker_.button(now_ns, pressed_);
  if (master_.failed()) end_master(now_ns + kRespawn_ns);
}

void World::step_second(std::int64_t now_ns) {
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

void World::step_slave(std::int64_t now_ns, const std::vector<FaultWindow>& attacks) {
  SiteTime& time = slave_.time;
  time.next_ns += time.period_ns();
  attack(now_ns, attacks);
  if (!slave_.running() || time.asleep) return;
  commands_.clear();
  receive(now_ns, forward_);
  if (second_) receive(now_ns, second_forward_);
  for (const Datagram& datagram : injected_) commands_.push_back({datagram.block, time.stamp(now_ns)});
  injected_.clear();
  hear_stops(now_ns);

  const slave::SlaveOutputs out = slave_.step(time.clock.local(now_ns), commands_);
  if (out.state) {
    followed_epoch_ = out.state->master_epoch;
    backward_.push(now_ns, *out.state);
    if (second_) second_backward_.push(now_ns, *out.state);
  }
  Observation seen = truth(now_ns);
  seen.reference = out.reference;
  seen.permitted = out.interlock == Interlock::kReady && out.laser_w > 0.0;
  if (out.applied_tick >= 0.0) {
    const auto born = births_.of(followed_epoch_, static_cast<Tick>(out.applied_tick));
    if (born) seen.age_s = static_cast<double>(now_ns - *born) * 1e-9;
  }
  checker_.observe(seen);
  if (!slave_.started()) checker_.interrupted();
  if (slave_.failed()) end_slave(now_ns, now_ns + kRespawn_ns);
}

Observation World::truth(std::int64_t now_ns) const {
  Observation seen{.now_ns = now_ns, .period_s = static_cast<double>(slave_.time.period_ns()) * 1e-9};
  seen.tool_m = slave_.tool_m();
  seen.velocity_m_per_s = slave_.velocity_m_per_s();
  seen.told_w = slave_.laser.told_w;
  seen.emitted_w = slave_.laser.emitted_w;
  seen.stuck = slave_.laser.stuck || slave_.laser.deaf;
  return seen;
}

void World::hear_stops(std::int64_t now_ns) {
  while (!to_slave_.empty() && to_slave_.front().due_ns <= now_ns && clogged_ == 0) {
    const Saying saying = to_slave_.front();
    to_slave_.erase(to_slave_.begin());
    slave_.hear(saying.stop);
    if (saying.stop.set) checker_.off_is_due();
    checker_.needs_restart(saying.said_ns);
  }
}

void World::send(std::int64_t now_ns, const CommandBlock& block, simulation::VirtualLink<Datagram>& link) {
  link.push(now_ns, Datagram{.block = block, .genuine = true, .born_ns = now_ns}, command_cost_(block));
  if (&link != &forward_) return;
  forger_.saw(block);
  const auto& kinds = settings_.kinds;
  if (std::find(kinds.begin(), kinds.end(), FaultKind::kReplayer) != kinds.end())
    replayer_.saw(now_ns, block);
}
void World::attack(std::int64_t now_ns, const std::vector<FaultWindow>& attacks) {
  for (const FaultWindow& window : attacks) {
    if (window.kind == FaultKind::kForger) forger_.step(now_ns, window, births_, injected_);
    if (window.kind == FaultKind::kReplayer) replayer_.step(now_ns, window, births_, injected_);
  }
  if (!slave_.running()) injected_.clear();
}

void World::receive(std::int64_t now_ns, simulation::VirtualLink<Datagram>& link) {
  arrived_.clear();
  link.deliver(now_ns, arrived_);
  for (const auto& [datagram, due_ns] : arrived_) {
    if (datagram.block.epoch == master_epoch_) checker_.needs_restart(master_began_ns_);
    checker_.heard(now_ns, datagram.born_ns);
    commands_.push_back({datagram.block, slave_.time.stamp(due_ns)});
  }
}

}  // namespace telekerf::experiments
