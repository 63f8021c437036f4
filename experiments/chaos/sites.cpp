// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/sites.h"

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

void count(Refused& refused, const std::string& reason, std::uint64_t times) {
  if (times > 0) refused[reason] += times;
}

}  // namespace

MasterSite::MasterSite(const master::StationSettings& settings, const bool& pressed)
    : settings_(settings),
      model_(robot::load_robot(settings.robot)),
      truth_(robot::mismatched(model_, settings.mismatch, settings.seed)),
      pressed_(pressed),
      rest_in_base_m_(model_.in_base(Vec3::Zero())) {}

void MasterSite::start(std::uint32_t epoch, const ContourMessage& contour, Refused& refused) {
  settings_.epoch = epoch;
  station_ = std::make_unique<master::Station>(
      settings_, faulty_drive(truth_, settings_.seed, rest_in_base_m_, sound_), scripted_button(pressed_));
  publish(contour, refused);
}

void MasterSite::end(Refused& refused) {
  if (!station_) return;
  count(refused, "state: not decodable, of another contour or sender, or from the future",
        station_->node().states().refused);
  count(refused, "state: repeated or too late", station_->node().states().stale);
  rest_in_base_m_ = station_->machine().plant()->true_tool_in_base_m();
  station_.reset();
  guided_.clear();
}

void MasterSite::publish(const ContourMessage& contour, Refused& refused) {
  if (contour.id != digest_of(contour)) {
    ++refused["contour: not what its id says"];
    return;
  }
  contour_ = contour;
  prepare(refused);
}

void MasterSite::prepare(Refused& refused) {
  try {
    guided_.push_back(station_->prepare(contour_));
  } catch (const StartupError&) {
    ++refused["scale or contour: beyond the master's reach"];
  }
}

master::StationOutputs MasterSite::step(std::int64_t now_ns, std::span<const Received<StateBlock>> states,
                                        std::span<const EventMessage> events, Refused& refused) {
  auto out = station_->step(now_ns, guided_.empty() ? nullptr : guided_.back().get(), states, events,
                            stops_.order());
  if (out.stop != 0) (void)stops_.quoted(out.stop);
  if (out.prepare_anew) prepare(refused);
  return out;
}

SlaveSite::SlaveSite(const slave::StationSettings& settings)
    : settings_(settings),
      model_(robot::load_robot(settings.robot)),
      truth_(robot::mismatched(model_, settings.mismatch, settings.seed + 1000)),
      rest_in_base_m_(model_.in_base(Vec3::Zero())) {}

void SlaveSite::start(std::uint32_t epoch, const ContourMessage& contour, Refused& refused) {
  settings_.epoch = epoch;
  sensor.slip_m.setZero();  // a robot is homed when its process begins
  laser.unheard = 0;
  station_ = std::make_unique<slave::Station>(
      settings_, faulty_drive(truth_, settings_.seed + 1000, rest_in_base_m_, sensor), faulty_laser(laser));
  publish(contour, refused);
}

void SlaveSite::end(Refused& refused) {
  if (!station_) return;
  const slave::SlaveCounters counters = station_->node().counters();
  count(refused, "command: not decodable, of another contour or sender, or from the future",
        counters.refused);
  count(refused, "command: repeated or too late", counters.stale);
  rest_in_base_m_ = station_->machine().plant()->true_tool_in_base_m();
  station_.reset();
  corridors_.clear();
}

bool SlaveSite::publish(const ContourMessage& contour, Refused& refused) {
  if (contour.id != digest_of(contour)) {
    ++refused["contour: not what its id says"];
    return false;
  }
  try {
    corridors_.push_back(station_->prepare(contour));
    return true;
  } catch (const StartupError&) {
    ++refused["contour: beyond the slave's reach"];
    return false;
  }
}

slave::SlaveOutputs SlaveSite::step(std::int64_t now_ns, std::span<const Received<CommandBlock>> commands) {
  auto out = station_->step(now_ns, corridors_.empty() ? nullptr : corridors_.back().get(), commands,
                            stops_.order());
  if (out.stop != 0) (void)stops_.quoted(out.stop);
  return out;
}

}  // namespace telekerf::experiments
