// SPDX-License-Identifier: Apache-2.0
// A cell of real processes that cuts, with the slave's robot and laser in telekerf-plant: its book, by the
// clock, is the judge. Nothing that the slave says of itself counts.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/runtime/clock.h"
#include "tests/system/programs.h"

namespace telekerf::integration {

/// Of the clock that the book is kept by.
inline double clock_s() { return 1e-9 * static_cast<double>(monotonic_ns()); }

class PlantCell {
 public:
  using Words = std::vector<std::string>;
  struct Flags {
    Words plant = {}, slave = {}, master = {"--engage", "--button", "pressed"}, all = {"--netem", "none"};
  };

  PlantCell(const std::string& name, Flags given) : flags(std::move(given)), name_(name) {
    folder_ = Program::scratch() / name;
    plant = std::make_unique<Program>("telekerf-plant",
                                      in_cell(joined({"--record", folder_.string()}, flags.plant), {}));
    if (!plant->says(", laser ", std::chrono::seconds(20))) return;
    const std::string said = plant->output();
    drive_ = after(said, "drive ");
    laser_ = after(said, "laser ");
    vision = std::make_unique<Program>("telekerf-vision", in_cell({"--image", "circle"}, flags.all));
    start_slave();
    start_master();
  }

  void start_slave() {
    slave = std::make_unique<Program>(
        "telekerf-slave",
        in_cell(joined({"--drive", drive_, "--drive-stale-s", "0.5", "--laser", laser_, "--stop-file", "off"},
                       flags.slave),
                flags.all));
  }
  void start_master() {
    master = std::make_unique<Program>("telekerf-master",
                                       in_cell(joined({"--stop-file", "off"}, flags.master), flags.all));
  }

  /// The plant has said one time more than `before` that there is light.
  bool lit(int before = 0, std::chrono::seconds timeout = std::chrono::seconds(30)) const {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (lights_said() <= before) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }
  int lights_said() const {
    int n = 0;
    const std::string all = plant->output();
    for (std::size_t at = all.find("plant: lit"); at != all.npos; at = all.find("plant: lit", at + 1)) ++n;
    return n;
  }
  /// Exit code of telekerf-ctl.
  int tell(const Words& words) const {
    return Program("telekerf-ctl", in_cell(words, {})).wait(std::chrono::seconds(20));
  }

  /// Ends the plant and gives what it has booked.
  nlohmann::json book() {
    plant->interrupt();
    (void)plant->wait(std::chrono::seconds(10));
    return nlohmann::json::parse(std::ifstream(folder_ / "plant.json"), nullptr, false);
  }
  std::string said() const {
    std::string all;
    for (const auto* program : {&plant, &vision, &slave, &master})
      if (*program) all += (*program)->output();
    return all;
  }
  Words in_cell(const Words& words, const Words& more) const {
    return joined(joined(words, {"--domain", own_domain(), "--cell", name_}), more);
  }

  Flags flags;
  std::unique_ptr<Program> plant, vision, slave, master;

 private:
  static Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::string after(const std::string& said, const std::string& word) {
    const std::size_t at = said.find(word);
    if (at == said.npos) return "";
    const std::size_t from = at + word.size();
    return said.substr(from, said.find_first_of(",\n", from) - from);
  }

  std::string name_;
  std::filesystem::path folder_;
  std::string drive_, laser_;
};

/// What was given of light from one time to another, J, as if each light had been even.
inline double energy_j(const nlohmann::json& book, double from_s, double to_s) {
  double sum_j = 0.0;
  for (const auto& light : book["lights"]) {
    const double begin_s = light["from_s"].get<double>(), end_s = light["to_s"].get<double>();
    const double share_s = std::min(end_s, to_s) - std::max(begin_s, from_s);
    if (share_s > 0.0) sum_j += light["energy_j"].get<double>() * share_s / (end_s - begin_s);
  }
  return sum_j;
}

/// Faults come while the cell cuts; at the end the book tells whether it was dark where it had to be.
class CellAtWork : public testing::Test {
 protected:
  static constexpr double kSilence_s = 0.003;  ///< docs/how-to/add-a-laser.md
  static constexpr int kGate_ms = 350;         ///< --beam-age-s
  /// What may go by between a look at the clock and the fault: a signal takes its time on a busy machine.
  static constexpr double kMargin_s = 0.1;
  static constexpr double kNever_s = 1e9;

  /// Of its own, as far as a cell's name may be long.
  static std::string cell_name() {
    return std::string(testing::UnitTest::GetInstance()->current_test_info()->name()).substr(0, 40);
  }
  /// It cuts.
  void begin(PlantCell::Flags flags = {}) {
    cell.emplace(cell_name(), std::move(flags));
    ASSERT_TRUE(cell->lit()) << cell->said();
    sleep_ms(300);
  }
  /// Dark for a second more, then one engagement is enough.
  void dark_until_engaged(double from_s) {
    sleep_ms(1000);
    const int before = cell->lights_said();
    dark.emplace_back(from_s, clock_s());
    // Heard at once; it goes on to look for listeners that a plant and a vision are not.
    const Program engage("telekerf-ctl", cell->in_cell({"engage"}, {}));
    EXPECT_TRUE(cell->lit(before)) << "one engagement is enough\n" << cell->said();
    sleep_ms(300);
  }
  /// The process is stopped that long; after more than the gate nothing comes back by itself.
  void hang(Program& program, int hung_ms) {
    program.interrupt(SIGSTOP);
    const double from_s = clock_s() + kMargin_s;
    sleep_ms(hung_ms);
    const double to_s = clock_s();
    program.interrupt(SIGCONT);
    if (hung_ms > kGate_ms) {
      dark_until_engaged(from_s);
    } else {
      dark.emplace_back(from_s, to_s);
      sleep_ms(400);
    }
  }
  void TearDown() override {
    if (!cell || !cell->plant->running()) return;
    const auto book = cell->book();
    ASSERT_TRUE(book.is_object()) << "the plant has left no book\n" << cell->said();
    EXPECT_EQ(book["energy_outside_corridor_j"].get<double>(), 0.0) << book;
    EXPECT_GT(book["energy_inside_j"].get<double>(), 1.0) << "it had been cutting\n" << cell->said();
    EXPECT_LE(book["dark_after_s_max"].get<double>(), kSilence_s) << book;
    EXPECT_LE(book["dose_j_max"].get<double>(), 2.0) << book;
    for (const auto& [from_s, to_s] : dark)
      EXPECT_EQ(energy_j(book, from_s, to_s), 0.0) << from_s << " to " << to_s << " s\n" << book;
    judge(book);
  }
  /// What a test asks beyond that.
  std::function<void(const nlohmann::json& book)> judge = [](const nlohmann::json&) {};
  static void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

  std::optional<PlantCell> cell;
  std::vector<std::pair<double, double>> dark;  ///< from, to
};

}  // namespace telekerf::integration
