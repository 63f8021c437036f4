// SPDX-License-Identifier: Apache-2.0
#include "master/station.h"

#include <algorithm>
#include <utility>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"
#include "master/constraint/reach.h"
#include "master/stream_report.h"

namespace telekerf::master {
namespace {

/// The slave waits for the button to be let go before it counts.
bool wants_release(const StateHeader* slave) noexcept {
  return slave != nullptr && (slave->guards & kButtonGuard) != 0;
}

constexpr std::size_t kMostContours = 64;

}  // namespace

Station::Station(const StationSettings& settings, robot::Drive drive, std::unique_ptr<OperatorInput> input,
                 std::unique_ptr<OperatorInput> hand)
    : given_(settings),
      settings_(settings.validated()),
      model_(robot::load_robot(settings_.robot)),
      machine_(model_, settings_.machine, settings_.node.control_hz,
               drive.robot
                   ? std::move(drive)
                   : robot::open_drive(
                         settings_.machine.drive,
                         {model_, settings_.node.control_hz, {settings_.mismatch, settings_.seed, {}}}),
               robot::Pushed::kYes),
      requests_(settings_.engage, settings_.beta),
      streams_(choice_of(given_)),
      hand_(settings_.arm, hand ? std::move(hand) : open_hand(settings_.hand_device, settings_.cap)),
      operator_(input ? std::move(input) : open_operator_input(settings_.button)),
      simulated_button_(settings_.button == "pressed" || (!operator_ && hand_.simulated())),
      node_(model_, settings_.node, settings_.epoch),
      recorder_(static_cast<std::size_t>(settings_.record_s * settings_.node.control_hz)) {
  control::require_stable(control::loop_conditions(model_, settings_.node.control_hz), node_.bandwidths(),
                          "constraint_rad_s", "observer_rad_s");
  contours_.reserve(kMostContours);
}

std::unique_ptr<GuidedContour> Station::prepare(const ContourMessage& contour) {
  const double beta = requests_.wanted_beta();
  try {
    require_room(model_, contour.points_m, beta);
    GuidePath guide = make_guide(contour, beta, settings_.node.constraint);
    require_reach(model_, guide, settings_.node.constraint.corridor_m);
    SimulatedOperator hand(guide.curve.line(), settings_.hand, settings_.seed);
    auto task = std::make_unique<GuidedContour>(GuidedContour{std::move(guide), std::move(hand), {}, {}, {}});
    requests_.granted(beta);
    prepare_stream(*task);
    return task;
  } catch (const StartupError&) {
    requests_.refused(beta);
    throw;
  }
}

void Station::prepare_stream(GuidedContour& task) {
  const StreamChoice choice = streams_.wanted();
  if (choice == streams_.in_force()) return;
  try {
    task.choice = choice;
    task.settings = with_choice(given_, choice).validated().node.command;
    task.stream = std::make_unique<CommandStream>(task.settings, settings_.epoch);
  } catch (const StartupError&) {
    streams_.refuse(choice);
    throw;
  }
}

const char* Station::obstacle() const noexcept {
  const StateHeader* const slave = node_.slave();
  if (slave == nullptr || (slave->guards & kRealLaser) == 0) return nullptr;
  if (settings_.engage)
    return "engage: the slave's laser is not simulated, so it is engaged by somebody who looks at it; leave "
           "--engage "
           "out and say telekerf-ctl engage";
  if (settings_.button == "pressed")
    return "button = pressed: the slave's laser is not simulated, so its button is held by a hand or a foot; "
           "name a "
           "pedal (--button udp:HOST:PORT)";
  return nullptr;
}

void Station::hear(std::span<const EventMessage> events, bool stopped, StationOutputs& out) noexcept {
  const StateHeader* const slave = node_.slave();
  const bool beam_on = slave != nullptr && slave->laser_on;
  for (const EventMessage& event : events) {
    if (StreamRequests::concerns(event)) {
      out.judge(event.epoch, streams_.hear(event, {stopped, engaged_ || requests_.engage(), beam_on}));
      out.prepare_anew = out.prepare_anew || streams_.pending();
    }
    if (!OperatorRequests::concerns(event)) continue;
    const OperatorRequests::Heard heard = requests_.hear({&event, 1}, {stopped, beam_on, streams_.pending()});
    out.judge(event.epoch, heard.refusal);
    out.prepare_anew = out.prepare_anew || heard.rescale;
  }
}

void Station::take_stream(GuidedContour* task, StationOutputs& out) noexcept {
  if (const auto asker = streams_.take_refused(); asker != 0) out.judge(asker, StreamRequests::kCannotBeMade);
  if (task == nullptr || task->stream == nullptr || engaged_ || !streams_.grant(task->choice)) return;
  node_.exchange(task->stream);
  settings_.node.command = task->settings;
  settings_.codec = codec::kCodecs.rows()[task->choice.codec].value;
}

StationOutputs Station::step(std::int64_t now_ns, GuidedContour* task,
                             std::span<const Received<StateBlock>> states,
                             std::span<const EventMessage> events, const StopOrder& stop) noexcept {
  StationOutputs out;
  const StateHeader* const slave = node_.slave();
  hear(events, stop.number != 0, out);
  take_stream(task, out);
  const Tick tick = node_.tick();
  const std::optional<Vec3> true_tool_m = machine_.true_tool_m();
  MasterInputs inputs;
  inputs.joints = machine_.read();
  const OperatorSample told = operator_ ? operator_->sample(now_ns) : OperatorSample{};
  out.say_stop = told.stop;
  if (!machine_.started()) {  // nobody knows where the tool is: nothing to decide, nothing to tell the slave
    out.stop = stop.number;
    if (stop.number != 0) requests_.spend_engage();
    machine_.write(Vec3::Zero());
    return out;
  }
  inputs.states = states;
  inputs.stop = stop;
  inputs.engage = requests_.engage() && obstacle() == nullptr;
  inputs.constraint = constraint_;
  constraint_.reset();
  const double beta = task != nullptr ? task->guide.beta : settings_.beta;
  HandSample hand = hand_.sample(now_ns, static_cast<double>(tick) * control_period_s(), machine_,
                                 task != nullptr ? &task->hand : nullptr, beta, guided_);
  if (task != nullptr) {
    const std::uint32_t id = task->guide.contour_id;
    if ((contours_.empty() || contours_.back().id != id) && contours_.size() < contours_.capacity())
      contours_.push_back({tick, id});
    inputs.guide = &task->guide;
    if (told.force_n) hand.force_n = *told.force_n;
    inputs.button = operator_ ? told.trigger : hand.trigger;
    inputs.pedal = settings_.button.starts_with("udp:") || hand_.held();  // a lease is a dead-man of its own
    if (simulated_button_ && (!engaged_ || wants_release(slave))) inputs.button = false;
  }
  static_cast<MasterOutputs&>(out) = node_.step(now_ns, inputs);
  engaged_ = out.mode == MasterMode::kEngaged;
  if (out.engage_spent) requests_.spend_engage();
  const char* const over =
      requests_.wait(now_ns, {.led = engaged_, .guiding = out.mode == MasterMode::kGuiding,
                              .slave_gone = node_.slave_gone(now_ns), .most_s = settings_.beam_age_s});
  if (out.let_go == nullptr) out.let_go = over;
  guided_ = out.mode == MasterMode::kGuiding || out.mode == MasterMode::kEngaged;
  if (inputs.joints.valid) machine_.watch(out.tool_m);
  machine_.write(out.currents_a);
  if (robot::SimulatedRobot* const plant = machine_.plant()) {
    plant->set_tool_force(hand.force_n);
  } else {
    hand.force_n = out.hand_n;
  }
  const MasterRow row{tick, static_cast<double>(now_ns) * 1e-9, true_tool_m.value_or(out.tool_m), hand.force_n,
                      out.constraint_n, guided_, out.mode == MasterMode::kEngaged, inputs.button,
                      out.observed.slave.position_m, out.observed.aligned, beta,
                      out.slave_force.known ? static_cast<double>(out.slave_force.tick) : -1.0,
                      out.slave_force.force_n};
  ring_ != nullptr ? ring_->push(master_columns(), row) : recorder_.push(row);
  hand_.answer({.now_ns = now_ns,
                .guided = guided_,
                .tool_m = beta * out.tool_m.head<2>(),
                .force_n = hand.force_n.head<2>()});
  machine_.advance();
  return out;
}

void Station::report_contours(std::span<const ContourMessage> adopted, RunRecord& record) const {
  const auto message_of = [&](std::uint32_t id) {
    return std::find_if(adopted.begin(), adopted.end(), [&](const ContourMessage& m) { return m.id == id; });
  };
  for (std::size_t n = 0; n + 1 < contours_.size(); ++n) {
    const auto found = message_of(contours_[n].id);
    if (found != adopted.end())
      record.earlier.push_back({contours_[n + 1].tick, found->closed, found->points_m});
  }
  if (contours_.empty()) return;
  const auto last = message_of(contours_.back().id);
  if (last == adopted.end()) return;
  record.contour_m = last->points_m;
  record.contour_closed = last->closed;
  record.words["image"] = last->source;
  record.words["mode"] = last->mode;
}

void Station::report(RunRecord& record) const {
  record.master = recorder_.rows();
  record.master_drive = {settings_.machine.drive, machine_.plant() != nullptr};
  for (const auto& [name, count] : {std::pair{"drive_refused", machine_.refused()},
                                    {"button_refused", button_refused()}, {"hand_refused", hand_refused()},
                                    {"readings_missed", machine_.readings_missed()}, {"dropped_rows", recorder_.dropped()}})
    record.master_figures[name] = static_cast<double>(count);
  report_stream(settings_, node_, record);
}

}  // namespace telekerf::master
