// SPDX-License-Identifier: Apache-2.0
// A cell of real processes that cuts, with the slave's robot and laser in telekerf-plant: its book, by the
// clock, is the judge. Nothing that the slave says of itself counts.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/runtime/clock.h"
#include "tests/system/programs.h"

namespace telekerf::integration {

/// Of the clock that the book is kept by.
inline double clock_s() { return 1e-9 * static_cast<double>(monotonic_ns()); }

class PlantCell {
 public:
  using Words = std::vector<std::string>;
  struct More {
    Words plant = {}, slave = {}, master = {"--engage", "--button", "pressed"}, all = {"--netem", "none"};
  };

  PlantCell(const std::string& name, More more) : name_(name), more_(std::move(more)) {
    folder_ = Program::scratch() / name;
    plant = std::make_unique<Program>("telekerf-plant",
                                      in_cell(joined({"--record", folder_.string()}, more_.plant), {}));
    if (!plant->says("\n", std::chrono::seconds(20))) return;
    const std::string said = plant->output();
    drive_ = after(said, "drive ");
    laser_ = after(said, "laser ");
    vision = std::make_unique<Program>("telekerf-vision", in_cell({"--image", "circle"}, more_.all));
    start_slave();
    start_master();
  }

  void start_slave() {
    slave = std::make_unique<Program>(
        "telekerf-slave",
        in_cell(joined({"--drive", drive_, "--drive-stale-s", "0.5", "--laser", laser_, "--stop-file", "off"},
                       more_.slave),
                more_.all));
  }
  void start_master() {
    master = std::make_unique<Program>("telekerf-master",
                                       in_cell(joined({"--stop-file", "off"}, more_.master), more_.all));
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
  More more_;
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

}  // namespace telekerf::integration
