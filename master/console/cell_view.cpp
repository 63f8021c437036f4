// SPDX-License-Identifier: Apache-2.0
#include "master/console/cell_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/protocol/sentences.h"
#include "master/modes.h"

namespace telekerf::master {
namespace {

/// Another slave is listened to after this silence.
constexpr double kAnother_s = 0.6;

double age_s(bool heard, std::int64_t then_ns, std::int64_t now_ns) noexcept {
  return heard ? static_cast<double>(now_ns - then_ns) * 1e-9 : -1.0;
}

bool fresh(double age_s) noexcept { return age_s >= 0.0 && age_s < CellView::kStale_s; }

}  // namespace

void CellView::Rate::add(std::uint32_t more, std::int64_t now_ns) noexcept {
  (void)per_s(now_ns);
  bytes += more;
}

double CellView::Rate::per_s(std::int64_t now_ns) noexcept {
  const double passed_s = static_cast<double>(now_ns - since_ns) * 1e-9;
  if (passed_s >= 1.0) {
    last = passed_s < 2.0 ? bytes / passed_s : 0.0;
    bytes = 0.0;
    since_ns = now_ns;
  }
  return last;
}

void CellView::hear(const Received<CommandBlock>& command) {
  commands_.add(command_cost_(command.value), command.received_ns);
  command_ticks_ = std::max<int>(1, command.value.ticks_per_sample);
  works_on(command.value.contour_id);
}

void CellView::hear(const Received<StateBlock>& received) {
  const StateBlock& state = received.value;
  states_rate_.add(state_cost_(state), received.received_ns);
  if (!states_ || state.master_epoch != states_epoch_) {
    states_epoch_ = state.master_epoch;
    states_ = std::make_unique<streaming::StateReceiver>(kAnother_s, states_epoch_, command_ticks_);
  }
  const streaming::Feedback& feedback = states_->receive(received);
  if (feedback.kind != streaming::Arrival::Kind::kNew) return;
  slave_ = states_->header();
  slave_ns_ = received.received_ns;
  slave_heard_ = true;
  works_on(slave_.contour_id);
  recall();
  for (const streaming::SlaveSample& sample : feedback.samples) {
    if (slave_.laser_on && contour_) {
      mark_.add(sample.position_m.head<2>());
      depths_.burn(sample.position_m.head<2>(), sample.velocity_m_per_s.head<2>().norm(),
                   1e-9 * slave_.sample_period_ns);
    }
    compare(sample);
  }
  if (feedback.samples.empty()) return;
  slave_m_ = feedback.samples.back().position_m.head<2>();
  slave_speed_m_per_s_ = feedback.samples.back().velocity_m_per_s.head<2>().norm();
}

void CellView::recall() {
  if (!before_ || slave_.contour_id == 0) return;  // a slave that begins may still get its contour
  if (slave_.contour_id != before_->contour_id || slave_.epoch != before_->slave_epoch) return before_.reset();
  if (!contour_ || contour_->id != slave_.contour_id) return;  // it is still on its way
  for (const Vec2& place_m : before_->places_m) mark_.add(place_m);
  depths_.add(before_->lit_s);
  if (wish_.material == nullptr) wish_.material = before_->wish.material;
  if (!wish_.depth_m) wish_.depth_m = before_->wish.depth_m;
  ++wish_version_;
  before_.reset();
}

std::optional<CutSoFar> CellView::news_of_cut() {
  if (before_ || !contour_ || !slave_heard_ || contour_->id != slave_.contour_id) return std::nullopt;
  const std::uint64_t version = depths_version() + mark_.size();
  if ((mark_.size() == 0 && !wish_.said()) || cut_told_ == version) return std::nullopt;
  cut_told_ = version;
  const auto places = mark_.from(0, mark_.size());
  return CutSoFar{.contour_id = contour_->id,
                  .slave_epoch = slave_.epoch,
                  .places_m = {places.begin(), places.end()},
                  .lit_s = depths_.lit_s(),
                  .wish = wish_};
}

void CellView::compare(const streaming::SlaveSample& sample) noexcept {
  if (!sample.applied || sample.index < 0) return;
  const std::int64_t tick = sample.index * command_ticks_;
  for (const MasterMoment& moment : moments_) {
    if (moment.tick != tick) continue;
    tracking_m_ = (sample.position_m.head<2>() - moment.scaled_m).norm();
    prediction_m_ = (sample.position_m.head<2>() - moment.predicted_m).norm();
    return;
  }
}

void CellView::hear(const TelemetryMessage& telemetry, std::int64_t now_ns) {
  if (telemetry.role == "vision") {
    vision_.clear();
    for (const auto& [name, value] : telemetry.values) vision_[name] = value;
    vision_ns_ = now_ns;
  }
  if (telemetry.role != "master") return;
  for (const auto& [name, value] : telemetry.values) master_[name] = value;
  master_ns_ = now_ns;
  master_heard_ = true;
  answer_.reset();
  const std::int64_t tick = static_cast<std::int64_t>(telemetry.tick) - 1;  // counted on after the step
  moments_[static_cast<std::size_t>(tick / 10) % moments_.size()] = {
      tick, beta() * Vec2(value("tool_x_m"), value("tool_y_m")), {value("slave_x_m"), value("slave_y_m")}};
}

void CellView::hear(ContourMessage contour) {
  if (contour_ && contour_->id == contour.id) waiting_.reset();  // it is what vision sees again
  if (this->contour(contour.id) != nullptr) return;
  const bool first = !contour_;
  (first ? contour_ : waiting_) = std::move(contour);
  if (first) begin_depths();
  forget_pictures();
}

void CellView::works_on(std::uint32_t id) {
  if (contour_ && contour_->id == id) worked_on_ = true;
  // Of several contours only the last is told to who comes later: it may be one that nobody has taken yet.
  const bool awaited = waiting_ && waiting_->id == id;
  if (contour_ && !worked_on_ && id != 0 && contour_->id != id && !awaited) {
    waiting_ = std::move(contour_);
    contour_.reset();
    forget_pictures();
  }
  if (!awaited) return;
  worked_on_ = true;
  contour_ = std::move(waiting_);
  waiting_.reset();
  mark_.clear();
  begin_depths();
  forget_pictures();
}

const ContourMessage* CellView::contour(std::uint32_t id) const noexcept {
  if (contour_ && contour_->id == id) return &*contour_;
  return waiting_ && waiting_->id == id ? &*waiting_ : nullptr;
}

void CellView::hear(PreviewMessage preview) {
  const std::uint32_t id = preview.contour_id;
  pictures_[id] = {++picture_count_, std::move(preview)};
  forget_pictures();
}

void CellView::forget_pictures() {
  // The newest may be of a contour that is still on its way.
  std::erase_if(pictures_, [this](const auto& entry) {
    return contour(entry.first) == nullptr && entry.second.number != picture_count_;
  });
}

double CellView::zoom() const {
  const auto found = vision_.find("zoom");
  return found == vision_.end() ? 0.0 : found->second;
}

std::optional<double> CellView::level() const {
  const auto found = vision_.find("level");
  return found == vision_.end() ? std::nullopt : std::optional(found->second);
}

std::string CellView::imaging_sentence(std::int64_t now_ns) const {
  constexpr double kTelling_s = 3.0;  // vision tells once a second
  const auto of = [this](const char* name) {
    const auto found = vision_.find(name);
    return found == vision_.end() ? 0.0 : found->second;
  };
  if (!vision_.contains("magnification") || static_cast<double>(now_ns - vision_ns_) * 1e-9 > kTelling_s)
    return {};
  // As docs/how-to/imaging-unit.md counts them.
  constexpr std::array<std::string_view, 4> kStates{"searching the focus", "in focus", "no focus found",
                                                    "focus moved by the printed law"};
  const auto state = static_cast<std::size_t>(std::max(0.0, of("imaging_state")));
  return fmt::format("{}, {:.2f}x, focus {:.3f} mm, sharpness {:.3g}",
                     of("camera_gone") != 0.0 ? "camera or axes gone"
                     : state < kStates.size() ? kStates[state]
                                              : "state unknown",
                     of("magnification"), of("focus_mm"), of("sharpness_tenengrad"));
}

void CellView::hear(const UdpHandAnswer& answer) noexcept { answer_ = answer; }

double CellView::value(const char* name, double otherwise) const {
  const auto found = master_.find(std::string_view(name));
  return found == master_.end() ? otherwise : found->second;
}

bool CellView::master_fresh(std::int64_t now_ns) const noexcept {
  return fresh(age_s(master_heard_, master_ns_, now_ns));
}

bool CellView::slave_fresh(std::int64_t now_ns) const noexcept {
  return fresh(age_s(slave_heard_, slave_ns_, now_ns));
}

bool CellView::engaged(std::int64_t now_ns) const {
  return master_fresh(now_ns) && value("mode") == static_cast<double>(MasterMode::kEngaged);
}

std::optional<StreamChoice> CellView::stream() const {
  if (!master_.contains("law")) return std::nullopt;
  const auto number = [this](const char* name) { return static_cast<std::uint8_t>(value(name)); };
  return StreamChoice{.law = number("law"),
                      .estimator = number("estimator"),
                      .codec = number("codec"),
                      .block = number("block"),
                      .keep = number("keep"),
                      .redundancy = number("redundancy")};
}

PageFields CellView::fields(std::int64_t now_ns) {
  PageFields all{};
  const auto put = [&all](std::size_t place, double number) { all[place] = static_cast<float>(number); };
  const double beta = this->beta();
  put(page_field("master_age_s"), age_s(master_heard_, master_ns_, now_ns));
  put(page_field("slave_age_s"), age_s(slave_heard_, slave_ns_, now_ns));
  put(page_field("mode"), value("mode"));
  put(page_field("beta"), beta);
  put(page_field("tool_x_m"), answer_ ? answer_->x_m : beta * value("tool_x_m"));
  put(page_field("tool_y_m"), answer_ ? answer_->y_m : beta * value("tool_y_m"));
  put(page_field("speed_m_per_s"), beta * Vec2(value("tool_x_m_per_s"), value("tool_y_m_per_s")).norm());
  put(page_field("off_line_m"), beta * value("phi_m"));
  put(page_field("constraint_n"), value("constraint_n"));
  put(page_field("hand_x_n"), answer_ ? answer_->x_n : value("hand_x_n"));
  put(page_field("hand_y_n"), answer_ ? answer_->y_n : value("hand_y_n"));
  put(page_field("corridor_m"), beta * value("corridor_m"));
  put(page_field("circle_is_line"), value("circle_is_line"));
  put(page_field("circle_x_m"), beta * value("circle_x_m"));
  put(page_field("circle_y_m"), beta * value("circle_y_m"));
  put(page_field("circle_radius_m"), beta * value("circle_radius_m"));
  put(page_field("slave_x_m"), slave_m_.x());
  put(page_field("slave_y_m"), slave_m_.y());
  put(page_field("slave_speed_m_per_s"), slave_speed_m_per_s_);
  put(page_field("predicted_x_m"), value("slave_x_m"));
  put(page_field("predicted_y_m"), value("slave_y_m"));
  put(page_field("laser_on"), laser_on(now_ns) ? 1.0 : 0.0);
  put(page_field("interlock"), static_cast<double>(slave_.interlock));
  put(page_field("slave_mode"), static_cast<double>(slave_.mode));
  put(page_field("tracking_m"), tracking_m_);
  put(page_field("prediction_m"), prediction_m_);
  put(page_field("round_trip_s"), value("round_trip_s"));
  put(page_field("playout_s"), slave_.playout_ticks * 1e-9 * slave_.sample_period_ns);
  put(page_field("lost"), states_ ? static_cast<double>(states_->counters().lost) : 0.0);
  put(page_field("command_bytes_per_s"), commands_.per_s(now_ns));
  put(page_field("state_bytes_per_s"), states_rate_.per_s(now_ns));
  return all;
}

std::string CellView::sentence(const std::string& stop, std::int64_t now_ns) const {
  if (!stop.empty()) return stop;
  if (!master_heard_) return "The master is not heard: is telekerf-master running in this cell?";
  if (!master_fresh(now_ns)) return "The master has fallen silent: what you see is old";
  switch (static_cast<MasterMode>(value("mode"))) {
    case MasterMode::kIdle:
      return contour_ ? "The master holds its pose: it cannot take this contour yet"
                      : "No contour has come: is telekerf-vision running in this cell?";
    case MasterMode::kApproach:
      return "Your tool moves to the contour";
    case MasterMode::kGuiding:
      if (!slave_heard_)
        return "You may move along the line. The slave is not heard: is telekerf-slave running?";
      if (!slave_fresh(now_ns)) return "You may move along the line. The slave has fallen silent";
      if (!contour_)
        return "The cell works on a contour that this page has not seen; take the one that waits, or look anew";
      if (slave_.contour_id != contour_->id)
        return "You may move along the line. The slave works on another contour";
      return "You may move along the line; engage, and the slave follows";
    case MasterMode::kEngaged:
      if (!slave_fresh(now_ns)) return "Engaged, but the slave has fallen silent";
      if (slave_.mode == SlaveMode::kFollowing) {
        return value("off_line") != 0.0 ? "Engaged: you push the tool off the line, so the beam waits until it is back"
                                        : "Engaged: the slave follows";
      }
      return fmt::format("E{}", led_sentence_of(slave_.reason) + 1);
    case MasterMode::kStopped:
      return "Stopped: the master holds its pose";
  }
  return "The master is in a mode that this page does not know";
}

std::string CellView::beam_sentence(bool armed, std::int64_t now_ns) const {
  if (!slave_fresh(now_ns)) return "Beam: unknown, the slave is not heard";
  if (slave_.laser_on) return "Beam on";
  if (slave_.interlock != Interlock::kReady)
    return fmt::format("Beam off: {}", sentence_of(slave_.interlock));
  return armed ? "Beam ready: fire" : "Beam off: ready as soon as the laser is armed";
}

}  // namespace telekerf::master
