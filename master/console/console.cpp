// SPDX-License-Identifier: Apache-2.0
#include "master/console/console.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/protocol/network_choice.h"
#include "master/console/access.h"
#include "master/console/console_words.h"
#include "master/operator_requests.h"

namespace telekerf::master {
namespace {

using Json = nlohmann::json;

/// A page that draws and pulls says some 200 things a second, a fast pen 500.
constexpr int kMostInASecond = 1500;
constexpr std::size_t kMarksAtOnce = 1000;
/// The master's answer may come before a state is due, but no sooner after the last one than this.
constexpr std::int64_t kSoonest_ns = 7'000'000;
/// A state may come this much before its time; how many come in a second stays as it is.
constexpr std::int64_t kEarly_ns = 4'000'000;
/// Between two steps: mostly, and where something is to be said often.
constexpr std::int64_t kStep_ns = 16'000'000, kQuickStep_ns = 8'000'000;
/// A master that listens answers every frame at its next step.
constexpr std::int64_t kUnanswered_ns = 500'000'000;
/// A contour is prepared for another scale within this time.
constexpr std::int64_t kPreparing_ns = 3'000'000'000;
/// Between two looks at whether the words are others, and how deep the cut is.
constexpr std::int64_t kWords_ns = 40'000'000;
constexpr std::int64_t kDepths_ns = 500'000'000;
/// Waiting for one page.
constexpr std::size_t kMostAnswers = 8;
/// Who refuses says it once more, a little later (common/bus/event_answers.h).
constexpr std::int64_t kSaidAgain_ns = 1'000'000'000;
constexpr std::size_t kMostRefusals = 64;

}  // namespace

Console::Console(ConsoleSettings settings)
    : settings_(std::move(settings)),
      cell_(settings_.cut),
      stop_(settings_.source, settings_.epoch),
      seat_(settings_.epoch),
      last_stop_(settings_.epoch),
      echo_ms_(std::numeric_limits<double>::quiet_NaN()) {}

std::uint32_t Console::join(std::int64_t now_ns) {
  pages_[++last_page_].second_ns = now_ns;
  return last_page_;
}

void Console::leave(std::uint32_t page, std::int64_t now_ns) {
  if (seat_.drives(page)) release(now_ns);
  seat_.leave(page);
  pages_.erase(page);
}

void Console::release(std::int64_t now_ns) {
  if (last_hand_.flags == 0 || last_hand_.session != seat_.lease()) return;
  last_hand_.flags = 0;
  ++last_hand_.sequence;
  last_hand_.sent_ns = now_ns;
  outbox_.hand.push_back(last_hand_);
}

bool Console::floods(Page& page, std::int64_t now_ns) {
  if (now_ns - page.second_ns >= 1'000'000'000) {
    page.second_ns = now_ns;
    page.heard = 0;
  }
  const bool too_much = ++page.heard > kMostInASecond;
  if (too_much) ++counters_.flooded;
  return too_much;
}

void Console::hear_frame(std::uint32_t id, std::span<const std::byte> bytes, std::int64_t now_ns) {
  const auto page = pages_.find(id);
  if (page == pages_.end() || floods(page->second, now_ns)) return;
  const std::optional<PageFrame> frame = parse_frame(bytes);
  if (!frame) {
    ++counters_.malformed;
    return;
  }
  const std::optional<UdpHandFrame> hand = seat_.hear(id, *frame, now_ns);
  if (!hand || stop_.in_force()) return;
  last_hand_ = *hand;
  sent_ns_ = now_ns;
  if (unheard_ns_ == 0) unheard_ns_ = now_ns;
  outbox_.hand.push_back(*hand);
}

void Console::hear_command(std::uint32_t id, std::string_view json, std::int64_t now_ns) {
  const auto page = pages_.find(id);
  if (page == pages_.end()) return;
  const std::optional<PageCommand> command = parse_command(json);
  // A stop is heard whatever else the page sends.
  const bool stops = command && command->kind == PageCommand::Kind::kStop;
  if (floods(page->second, now_ns) && !stops) return;
  if (!command) {
    ++counters_.malformed;
    return;
  }
  obey(id, page->second, *command, now_ns);
}

void Console::answer(Page& page, std::string text) {
  if (page.said.size() == kMostAnswers) page.said.erase(page.said.begin());
  page.said.push_back(std::move(text));
}

void Console::refuse(Page& page, const std::string& why) {
  ++counters_.refused;
  answer(page, Json{{"type", "refused"}, {"why", why}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void Console::refuse_driver(const std::string& why) {
  for (auto& [id, page] : pages_) {
    if (seat_.drives(id)) refuse(page, why);
  }
}

void Console::vacate(std::int64_t now_ns) {
  release(now_ns);
  seat_.vacate();
}

void Console::tell(EventMessage::Kind kind, double value, const std::string& text) {
  outbox_.events.push_back({settings_.epoch, kind, value, text});
}

void Console::obey(std::uint32_t id, Page& page, const PageCommand& command, std::int64_t now_ns) {
  using Kind = PageCommand::Kind;
  // What everyone may.
  switch (command.kind) {
    case Kind::kStop:
      vacate(now_ns);
      stop_.stop(++last_stop_ == 0 ? ++last_stop_ : last_stop_, "the console's stop button", now_ns);
      return;
    case Kind::kPing:
      page.ping = command.value;
      return;
    case Kind::kRate:
      page.period_ns = static_cast<std::int64_t>(1e9 / std::clamp(command.value, 1.0, 125.0));
      page.due_ns = std::min(page.due_ns, now_ns + page.period_ns);
      return;
    case Kind::kTake:
      if (!token_matches(settings_.token, command.text))
        return refuse(page, "This page may watch and stop; to drive it needs the console's token");
      if (const auto lease = seat_.take(id, now_ns)) {
        echo_ms_ = std::numeric_limits<double>::quiet_NaN();  // another page has another clock
        return answer(page, Json{{"type", "lease"}, {"lease", *lease}}.dump());
      }
      return refuse(page, "Another page drives; it has to let go of the hand first");
    case Kind::kLeave:
      if (seat_.drives(id)) release(now_ns);
      seat_.leave(id);
      return;
    default:
      break;
  }
  if (!seat_.drives(id)) return refuse(page, "You watch: take the hand first");
  const bool beam_on = cell_.laser_on(now_ns);
  switch (command.kind) {
    case Kind::kEngage:
      if (stop_.in_force()) return refuse(page, "Not engaged: clear the stop first");
      return tell(EventMessage::Kind::kEngage);
    case Kind::kDisengage:
      seat_.arm(false);
      return tell(EventMessage::Kind::kDisengage);
    case Kind::kArm:
      if (command.value != 0.0 && stop_.in_force()) return refuse(page, "Not armed: clear the stop first");
      return seat_.arm(command.value != 0.0);
    case Kind::kBeta:
      if (!(command.value >= kSmallestBeta && command.value <= kLargestBeta))
        return refuse(page, fmt::format("The scale must be within [{}, {}]", kSmallestBeta, kLargestBeta));
      if (stop_.in_force()) return refuse(page, "No other scale while everything is stopped");
      if (beam_on) return refuse(page, "No other scale while the beam is on; let go of the fire button");
      seat_.arm(false);  // the master lets go of the slave, as at a disengagement
      asked_beta_ = command.value;
      asked_ns_ = now_ns;
      return tell(EventMessage::Kind::kSetBeta, command.value);
    case Kind::kClearStop:
      if (const std::string wrong = stop_.clear(now_ns); !wrong.empty()) refuse(page, wrong);
      return;
    case Kind::kLook:
      return tell(EventMessage::Kind::kLook, 0.0, command.text);
    case Kind::kMaterial: {
      const auto material = workpiece::kMaterials.find(command.text);
      if (!material) return refuse(page, fmt::format("No material of the name {} is known", command.text));
      return cell_.set_material(**material);
    }
    case Kind::kDepth:
      if (!(command.value >= 0.0 && command.value <= DepthWish::kDeepest_m))
        return refuse(page, fmt::format("The depth must be within [0, {:g}] mm; 0: none is wished",
                                        1e3 * DepthWish::kDeepest_m));
      return cell_.set_depth(command.value);
    case Kind::kTakeContour:
      if (cell_.waiting() == nullptr) return refuse(page, "No other contour waits");
      if (beam_on) return refuse(page, "No other contour while the beam is on; let go of the fire button");
      return tell(EventMessage::Kind::kTakeContour, cell_.waiting()->id);
    case Kind::kZoom:
      if (!(command.value >= 0.0 && command.value <= 1.0))
        return refuse(page, "The zoom must be within [0, 1]");
      if (beam_on) return refuse(page, "No other zoom while the beam is on; let go of the fire button");
      return tell(EventMessage::Kind::kSetZoom, command.value);
    case Kind::kRefocus:
      return tell(EventMessage::Kind::kRefocus);
    case Kind::kStream:  // the master says whether there is such a law
      if (stop_.in_force()) return refuse(page, "Law, estimator and codec stay while everything is stopped");
      if (cell_.engaged(now_ns))
        return refuse(page, "Law, estimator and codec change between two engagements: disengage first");
      return tell(EventMessage::Kind::kSetStream, 0.0, command.text);
    case Kind::kNetem:
      if (std::find(settings_.profiles.begin(), settings_.profiles.end(), command.text) ==
          settings_.profiles.end())
        return refuse(page, fmt::format("No network of the name {} is shipped", command.text));
      if (beam_on) return refuse(page, "No other network while the beam is on; let go of the fire button");
      if (!cell_.slave_fresh(now_ns)) profile_ = command.text;  // nobody decides, everyone does as it is told
      return tell(EventMessage::Kind::kSetNetem, kNetworkAsked, command.text);
    default:
      return;
  }
}

void Console::hear(const UdpHandAnswer& answer) noexcept {
  const auto passed = seat_.passed(answer.session, answer.sequence);
  if (passed) {
    echo_ms_ = passed->page_ms;
    step_s_ = static_cast<double>(answer.step_ns - passed->heard_ns) * 1e-9;
  }
  unheard_ns_ = 0;
  answer_ = answer;
  ++answers_;
  cell_.hear(answer);
}

void Console::hear(const EventMessage& event, std::int64_t now_ns) {
  if (event.kind == EventMessage::Kind::kSetNetem && event.value == kNetworkTaken)
    profile_ = event.text;
  if (event.kind != EventMessage::Kind::kAnswer || event.epoch != settings_.epoch || event.value != 1.0 ||
      event.text.ends_with(kAsAtTheSlave))
    return;
  std::erase_if(refusals_, [now_ns](const auto& heard) { return now_ns - heard.second > kSaidAgain_ns; });
  if (refusals_.size() < kMostRefusals && refusals_.emplace(event.text, now_ns).second) refuse_driver(event.text);
}

bool Console::deaf(std::int64_t now_ns) const noexcept {
  return unheard_ns_ != 0 && now_ns - unheard_ns_ > kUnanswered_ns && now_ns - sent_ns_ < kUnanswered_ns;
}

void Console::follow_up(std::int64_t now_ns) {
  constexpr double kSame = 1e-6;  // single precision on its way
  if (asked_beta_ == 0.0 || now_ns - asked_ns_ < kPreparing_ns) return;
  if (std::abs(cell_.beta() - asked_beta_) > kSame * asked_beta_)
    refuse_driver(fmt::format("The scale stays {:.2f}: the master cannot take the contour at {:.2f} now",
                              cell_.beta(), asked_beta_));
  asked_beta_ = 0.0;
}

void Console::step(std::int64_t now_ns) {
  seat_.step(now_ns);
  follow_up(now_ns);
  if (stop_.in_force() && !stopped_) vacate(now_ns);
  stopped_ = stop_.in_force();
}

std::int64_t Console::pause_ns() const noexcept {
  std::int64_t pause_ns = stop_.says() ? kQuickStep_ns : kStep_ns;
  for (const auto& [id, page] : pages_) pause_ns = std::min(pause_ns, std::max(page.period_ns, kQuickStep_ns));
  return pause_ns;
}

Console::Outbox Console::take_outbox() { return std::exchange(outbox_, {}); }

std::string Console::depth_sentence() const {
  const DepthWish& wish = cell_.wish();
  const DepthPlan plan(settings_.cut, wish.material_or_wood(), wish.depth_m.value_or(0.0));
  return (wish.material ? "" : "Nobody has told this console what lies there, so this is for wood: ") + plan.sentence();
}

std::string Console::words(std::uint32_t id, std::int64_t now_ns) const {
  const std::string stop = stop_.sentence();
  const DepthWish& wish = cell_.wish();
  return Json{{"type", "words"},
              {"sentence", cell_.sentence(stop, now_ns)},
              {"beam", cell_.beam_sentence(seat_.armed(), now_ns)},
              {"stopped", stop_.in_force()},
              {"driver", seat_.drives(id) ? "you"
                         : seat_.taken()  ? "other"
                                          : "nobody"},
              {"lease", seat_.drives(id) ? seat_.lease() : 0U},
              {"watchers", pages_.size() - (seat_.taken() ? 1U : 0U)},
              {"armed", seat_.armed()},
              {"engaged", cell_.engaged(now_ns)},
              {"profile", profile_},
              {"stream", stream_words(cell_.stream())},
              {"material", wish.material_or_wood().name},
              {"depth_m", wish.depth_m.value_or(0.0)},
              {"depth", depth_sentence()},
              {"deaf", deaf(now_ns)},
              {"contour", cell_.contour() ? cell_.contour()->id : 0U},
              {"waiting", cell_.waiting() != nullptr ? cell_.waiting()->id : 0U},
              {"pictures", picture_words(cell_)},
              {"imaging", cell_.imaging_sentence(now_ns)},
              {"level", cell_.level() ? Json(std::round(1e3 * *cell_.level()) / 1e3) : Json()},
              {"zoom", std::round(1e3 * cell_.zoom()) / 1e3}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

PageMessage Console::state(std::uint32_t id, std::int64_t now_ns) {
  PageFields fields = cell_.fields(now_ns);
  const std::uint32_t flags = answer_ ? answer_->flags : 0U;
  fields[page_field("held")] = (flags & UdpHandAnswer::kHeld) != 0 ? 1.0F : 0.0F;
  fields[page_field("trigger")] = (flags & UdpHandAnswer::kTrigger) != 0 ? 1.0F : 0.0F;
  fields[page_field("step_s")] = static_cast<float>(step_s_);
  fields[page_field("late_frames")] = static_cast<float>(seat_.late());
  const double echo_ms = seat_.drives(id) ? echo_ms_ : std::numeric_limits<double>::quiet_NaN();
  return {true, encode_state(fields, static_cast<double>(now_ns) * 1e-6, echo_ms)};
}

std::optional<PageMessage> Console::next(std::uint32_t id, std::int64_t now_ns) {
  const auto found = pages_.find(id);
  if (found == pages_.end()) return std::nullopt;
  Page& page = found->second;
  if (!page.greeted) {
    page.greeted = true;
    return PageMessage{false, hello_words(settings_)};
  }
  if (!page.said.empty()) {
    PageMessage message{false, std::move(page.said.front())};
    page.said.erase(page.said.begin());
    return message;
  }
  if (page.ping) {
    const double at = *std::exchange(page.ping, std::nullopt);
    return PageMessage{false, Json{{"type", "pong"}, {"at", at}}.dump()};
  }
  if (now_ns - page.words_ns >= kWords_ns) {
    page.words_ns = now_ns;
    if (std::string words = this->words(id, now_ns); words != page.words) {
      page.words = words;
      return PageMessage{false, std::move(words)};
    }
  }
  const MarkTrail& mark = cell_.mark();
  if (page.mark_generation != mark.generation()) {
    page.mark_generation = mark.generation();
    page.marks = 0;
    if (mark.size() == 0) return PageMessage{true, encode_mark({}, 0)};
  }
  if (page.marks < mark.size()) {
    const auto places = mark.from(page.marks, kMarksAtOnce);
    PageMessage message{true, encode_mark(places, static_cast<std::uint32_t>(page.marks))};
    page.marks += places.size();
    return message;
  }
  const std::uint64_t depths = cell_.depths_version();
  if (page.depths != depths && now_ns - page.depths_ns >= kDepths_ns) {
    page.depths = depths;
    page.depths_ns = now_ns;
    return PageMessage{true, encode_depths(cell_.depths().depths_m(settings_.cut, cell_.wish().material_or_wood()))};
  }
  const bool news = page.answered != answers_ && seat_.drives(id) && now_ns - page.state_ns >= kSoonest_ns;
  if (now_ns < page.due_ns - kEarly_ns && !news) return std::nullopt;
  page.state_ns = now_ns;
  page.due_ns = std::max(page.due_ns, now_ns - kEarly_ns) + page.period_ns;
  page.answered = answers_;
  return state(id, now_ns);
}

void Console::add_figures(Metrics& figures) const {
  figures["pages"] = static_cast<double>(pages_.size());
  figures["page_malformed"] = static_cast<double>(counters_.malformed);
  figures["page_flooded"] = static_cast<double>(counters_.flooded);
  figures["page_refused"] = static_cast<double>(counters_.refused);
  figures["page_frames_late"] = static_cast<double>(seat_.late());
}

std::string Console::contour_json(std::uint32_t id) const { return contour_words(cell_.contour(id)); }

}  // namespace telekerf::master
