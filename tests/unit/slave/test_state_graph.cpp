// SPDX-License-Identifier: Apache-2.0
// Every state that the slave's choice of following can be in, and every step from each of them, by
// breadth-first search over the real classes: what was ended stays ended, and one new engagement is always
// enough. The graph is in docs/reference/contract.md; TELEKERF_WRITE_GRAPH=1 writes it there.
#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/unit/slave/selector_fixture.h"

namespace telekerf::slave {
namespace {

/// Two steps without anything to follow are longer than the gate, one is not.
constexpr double kStep_s = 0.2;
constexpr FreshnessSettings kGate{.beam_age_s = 0.35, .follow_age_s = 2.5};
/// Engagements that a master may have counted up to.
constexpr std::uint32_t kMost = 2;

struct Robot : Selector {
  using Selector::model;
};

enum class Brings : std::uint8_t { kNothingYet, kNothingAnyMore, kSample };

/// All that a step depends on.
struct Input {
  bool stopped = false;
  std::uint32_t contour = 1;
  std::uint32_t master = 7;  ///< 0: nobody is heard
  Brings brings = Brings::kNothingYet;
  double silent_s = 0.0;
  bool engaged = true;
  std::uint32_t engage = 1, newest = 1;
  bool button = false, concealed = false;
  std::optional<double> age_s = 0.1;
};

/// What the page says of an engagement, kept beside the classes and by other means: what ended, and what was
/// seen since.
struct Ghost {
  std::uint32_t contour = 0, master = 0, floor = 0, leading = 0, newest_led = 0;
  bool engaged = false;   ///< an engagement above the floor has led since
  bool released = false;  ///< and the button was seen released since
  int unled = 0;          ///< steps without anything to follow, since then

  auto key() const {
    return std::tuple(contour, master, floor, leading, newest_led, engaged, released, unled);
  }
  void end(std::uint32_t newest) {
    floor = std::max({floor, newest, engaged ? newest_led : 0});
    engaged = released = false;
    unled = 0;
  }
  void see(const Input& in) {
    const bool good = in.brings == Brings::kSample && in.age_s && *in.age_s <= kGate.follow_age_s;
    const std::uint32_t newest = in.master != 0 ? in.newest : 0;
    if (in.master != 0 && in.master != master) {
      end(0);
      master = in.master;
      floor = in.newest;
    }
    if (in.stopped || in.contour != contour) end(newest);
    contour = in.contour;
    unled = good || !engaged ? 0 : unled + 1;
    if (unled * kStep_s > kGate.beam_age_s) end(0);
    if (in.silent_s > kGate.beam_age_s) end(newest);
    if (!good) return;
    if (*in.age_s > kGate.beam_age_s) {
      released = false;
    } else if (engaged && !in.concealed && !in.button) {
      released = true;
    }
    if (in.stopped || !in.engaged || in.engage <= floor) return;
    if (!engaged || leading != in.engage) released = false;
    newest_led = engaged ? std::max(newest_led, in.engage) : in.engage;
    engaged = true;
    leading = in.engage;
  }
};

struct State {
  ReferenceSelector selector{Robot::model(), {}, kStep_s, BareAccelerations::kObeyed, kGate};
  Ghost ghost;

  Selected step(const Input& in) {
    streaming::StreamSample sample;
    sample.engaged = in.engaged;
    sample.engage = in.engage;
    sample.button = in.button;
    sample.concealed = in.concealed;
    sample.generation = sample.block = 1;
    streaming::Played played;
    played.fresh = in.brings != Brings::kNothingAnyMore;
    if (in.brings == Brings::kSample) {
      played.sample = &sample;
      played.age_s = in.age_s;
      played.index = 1;
      played.cursor = 1.0;
      played.tick = 1.0;
    }
    ghost.see(in);
    return selector.step(played, {.stopped = in.stopped,
                                  .heard = in.master != 0,
                                  .master_epoch = in.master,
                                  .contour_id = in.contour,
                                  .newest_engage = in.master != 0 ? in.newest : 0,
                                  .silent_s = in.silent_s});
  }
  bool armed() const { return selector.arming().armed(); }
  bool counts() const { return selector.arming().button_armed(); }
  bool follows() const { return selector.mode() == SlaveMode::kFollowing; }
  /// But for what no later step depends on: where the tool is.
  bool same(const State& other) const {
    return selector.mode() == other.selector.mode() && selector.reason() == other.selector.reason() &&
           selector.arming() == other.selector.arming();
  }
};

std::vector<Input> every_input() {
  std::vector<Input> inputs;
  for (const bool stopped : {false, true})
    for (const std::uint32_t contour : {1U, 2U})
      for (const std::uint32_t master : {0U, 7U, 8U})
        for (const double silent_s : {0.0, 0.36}) {
          const auto add = [&](Input in) {
            in.stopped = stopped;
            in.contour = contour;
            in.master = master;
            in.silent_s = master != 0 ? silent_s : 0.0;
            inputs.push_back(in);
          };
          for (std::uint32_t newest = 0; newest <= kMost; ++newest) {
            add({.brings = Brings::kNothingYet, .newest = newest});
            add({.brings = Brings::kNothingAnyMore, .newest = newest});
            if (master == 0) continue;
            for (std::uint32_t engage = 0; engage <= newest; ++engage)
              for (const bool engaged : {false, true})
                for (const bool button : {false, true})
                  for (const bool concealed : {false, true})
                    for (const std::optional<double> age_s : {std::optional(0.35), std::optional(0.36),
                                                              std::optional(2.6), std::optional<double>()})
                      add({.brings = Brings::kSample,
                           .engaged = engaged,
                           .engage = engage,
                           .newest = newest,
                           .button = button,
                           .concealed = concealed,
                           .age_s = age_s});
          }
        }
  return inputs;
}

/// Every state that can be reached, the one at the start first. `visit`: of each step from each of them.
template <class Visit>
std::vector<State> reach(const Visit& visit) {
  const std::vector<Input> inputs = every_input();
  std::map<decltype(Ghost{}.key()), std::vector<std::size_t>> known;
  std::vector<State> states;
  std::deque<std::size_t> open;
  const auto meet = [&](const State& state) {
    auto& alike = known[state.ghost.key()];
    for (const std::size_t n : alike)
      if (states[n].same(state)) return;
    alike.push_back(states.size());
    open.push_back(states.size());
    states.push_back(state);
  };
  meet({});
  for (; !open.empty() && !testing::Test::HasFatalFailure(); open.pop_front()) {
    const State from = states[open.front()];
    for (const Input& in : inputs) {
      State to = from;
      const Selected out = to.step(in);
      visit(from, in, to, out);
      if (testing::Test::HasFatalFailure()) break;
      meet(to);
    }
  }
  return states;
}

const std::vector<State>& all_states() {
  static const std::vector<State> states = reach([](const auto&...) {});
  return states;
}

/// Whatever came before: nothing leads and no button counts without what the page asks for.
TEST(StateGraph, WhatWasEndedIsFollowedAndLitOnlyAfterANewEngagementAndAReleasedButton) {
  std::uint64_t steps = 0, followed = 0, lit = 0;
  const auto states = reach([&](const State&, const Input& in, const State& to, const Selected& out) {
    ++steps;
    const bool led = out.applied_tick >= 0.0;
    const bool could_burn = led && out.button && to.follows() && to.counts() && *in.age_s <= kGate.beam_age_s;
    ASSERT_EQ(in.stopped, to.selector.mode() == SlaveMode::kStopped);
    ASSERT_FALSE(in.stopped && (led || to.armed() || to.counts())) << "a stop is obeyed in its step";
    ASSERT_FALSE(to.armed() && !to.ghost.engaged);
    ASSERT_FALSE(to.counts() && !(to.armed() && to.ghost.released));
    ASSERT_FALSE(led && !(to.armed() && in.engaged && in.engage > to.ghost.floor));
    ASSERT_FALSE(led && !(in.age_s && *in.age_s <= kGate.follow_age_s));
    followed += led ? 1 : 0;
    lit += could_burn ? 1 : 0;
  });
  EXPECT_GT(states.size(), 500u);
  EXPECT_GT(followed, 1000u);
  EXPECT_GT(lit, 100u);
  std::printf("%zu states, %.1f million steps\n", states.size(), static_cast<double>(steps) * 1e-6);
}

/// Every cause has an exit: a stop that is over, one new engagement, a button released and pressed.
TEST(StateGraph, FromEveryStateOneEngagementIsEnough) {
  int tried = 0;
  for (State state : all_states()) {
    const std::uint32_t master = state.ghost.master, spent = state.selector.arming().spent();
    if (master == 0 || state.ghost.contour == 0 || spent >= kMost) continue;
    ++tried;
    Input in{.contour = state.ghost.contour,
             .master = master,
             .brings = Brings::kSample,
             .engage = kMost,
             .newest = kMost};
    for (const bool button : {false, false, true}) {
      in.button = button;
      const Selected out = state.step(in);
      EXPECT_GE(out.applied_tick, 0.0);
    }
    EXPECT_TRUE(state.follows() && state.counts());
  }
  EXPECT_GT(tried, 100);
}

/// As people are told.
std::string name_of(const State& state) {
  switch (state.selector.mode()) {
    case SlaveMode::kWaiting:
      return "waiting";
    case SlaveMode::kHolding:
      return "holding";
    case SlaveMode::kStopped:
      return "stopped";
    case SlaveMode::kFollowing:
      break;
  }
  return !state.armed() ? "coasting" : state.counts() ? "following, button counts" : "following";
}

/// One thing at a time, of a master and a contour that are known.
std::vector<std::pair<std::string, Input>> events(const State& from) {
  const std::uint32_t same = std::max(from.ghost.leading, 1U);
  Input led{.contour = from.ghost.contour,
            .master = from.ghost.master,
            .brings = Brings::kSample,
            .engage = same,
            .newest = same,
            .button = true};
  std::vector<std::pair<std::string, Input>> events;
  const auto add = [&](const char* name, const auto& change) {
    Input in = led;
    change(in);
    events.emplace_back(name, in);
  };
  add("the same engagement goes on, button pressed", [](Input&) {});
  add("the same, button released", [](Input& in) { in.button = false; });
  if (same < kMost) add("a new engagement", [](Input& in) { in.newest = ++in.engage; });
  add("disengaged", [](Input& in) { in.engaged = false; });
  add("commands too late for the beam", [](Input& in) { in.age_s = 0.36; });
  add("commands too old to follow, or of unknown age", [](Input& in) { in.age_s.reset(); });
  add("a sample is missing", [](Input& in) { in.brings = Brings::kNothingYet; });
  add("nothing comes any more", [](Input& in) { in.brings = Brings::kNothingAnyMore; });
  add("silence longer than the gate", [](Input& in) { in.silent_s = 0.36; });
  add("a stop", [](Input& in) { in.stopped = true; });
  add("another contour", [](Input& in) { in.contour = 3 - in.contour; });
  add("another master", [](Input& in) { in.master = 15 - in.master; });
  return events;
}

/// A row an event, a column a state; in it the states that follow, by what else the classes remember.
std::string graph() {
  const std::vector<std::string> columns{"waiting",  "following", "following, button counts",
                                         "coasting", "holding",   "stopped"};
  std::vector<std::string> rows;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> cells;
  for (const State& from : all_states()) {
    if (from.ghost.master == 0 || from.ghost.contour == 0) continue;
    for (const auto& [event, in] : events(from)) {
      State to = from;
      to.step(in);
      if (std::find(rows.begin(), rows.end(), event) == rows.end()) rows.push_back(event);
      cells[{event, name_of(from)}].insert(name_of(to));
    }
  }
  std::ostringstream out;
  out << "| in one step |";
  for (const std::string& column : columns) out << " " << column << " |";
  out << "\n| --- |";
  for (std::size_t n = 0; n < columns.size(); ++n) out << " --- |";
  out << "\n";
  for (const std::string& row : rows) {
    out << "| " << row << " |";
    for (const std::string& column : columns) {
      std::string cell;
      for (const std::string& to : cells[{row, column}]) cell += (cell.empty() ? "" : "; ") + to;
      out << " " << cell << " |";
    }
    out << "\n";
  }
  return out.str();
}

TEST(StateGraph, ThePageHasIt) {
  const std::string begin = "<!-- state graph -->\n", end = "<!-- end of the state graph -->";
  std::ifstream in(TELEKERF_CONTRACT_PAGE);
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  const std::size_t from = page.find(begin), to = page.find(end);
  ASSERT_TRUE(from != page.npos && to != page.npos);
  const std::string before = page.substr(0, from + begin.size()), after = page.substr(to);
  const std::string found = page.substr(before.size(), to - before.size()), made = graph();
  if (std::getenv("TELEKERF_WRITE_GRAPH") != nullptr)
    std::ofstream(TELEKERF_CONTRACT_PAGE) << before << made << after;
  else
    EXPECT_EQ(found, made) << "TELEKERF_WRITE_GRAPH=1 writes it anew";
}

}  // namespace
}  // namespace telekerf::slave
