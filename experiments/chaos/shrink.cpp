// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/shrink.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

constexpr double kParts[] = {0.5, 0.75, 0.9};

/// As a command line says it.
double rounded_up(double duration_s) { return std::ceil(duration_s * 10.0 - 1e-9) / 10.0; }

bool take_if_failing(ChaosSettings candidate, const StillFails& fails, ChaosSettings& smallest) {
  if (!fails(candidate)) return false;
  smallest = std::move(candidate);
  return true;
}

void shorten(const StillFails& fails, ChaosSettings& smallest) {
  for (const double part : kParts) {
    while (true) {
      ChaosSettings shorter = smallest;
      shorter.duration_s = rounded_up(part * smallest.duration_s);
      if (shorter.duration_s < shortest_s(smallest.mode) || shorter.duration_s >= smallest.duration_s) break;
      if (!take_if_failing(std::move(shorter), fails, smallest)) break;
    }
  }
}

void drop_faults(const StillFails& fails, ChaosSettings& smallest) {
  for (std::size_t i = 0; i < smallest.kinds.size();) {
    ChaosSettings fewer = smallest;
    fewer.kinds.erase(fewer.kinds.begin() + static_cast<std::ptrdiff_t>(i));
    if (!take_if_failing(std::move(fewer), fails, smallest)) ++i;
  }
}

}  // namespace

ChaosSettings shrink(const ChaosSettings& failing, const StillFails& fails) {
  ChaosSettings smallest = failing;
  if (smallest.mode == ChaosMode::kLiveness) {
    ChaosSettings unhealed = smallest;
    unhealed.mode = ChaosMode::kSafety;
    (void)take_if_failing(std::move(unhealed), fails, smallest);
  }
  shorten(fails, smallest);
  drop_faults(fails, smallest);
  shorten(fails, smallest);
  return smallest;
}

std::string command_line(const ChaosSettings& settings) {
  std::string faults;
  for (const FaultKind kind : settings.kinds) {
    if (!faults.empty()) faults += ',';
    faults += kFaults.word(kind);
  }
  std::string gate;
  if (settings.bars.gate_s != CheckerSettings{}.gate_s)
    gate = fmt::format(" --beam-age-s {:g}", settings.bars.gate_s);
  return fmt::format("telekerf-experiment chaos --runs 1 --seed {} --duration-s {:g} --mode {} --faults {}{}",
                     settings.seed, settings.duration_s, kChaosModes.word(settings.mode),
                     faults.empty() ? "none" : faults, gate);
}

std::vector<FaultKind> parse_faults(const std::string& words) {
  std::vector<FaultKind> kinds;
  if (words == "none") return kinds;
  for (std::size_t from = 0; from <= words.size();) {
    const std::size_t to = std::min(words.find(',', from), words.size());
    const std::string word = words.substr(from, to - from);
    const auto kind = kFaults.find(word);
    if (!kind) {
      std::string all;
      for (const auto& row : kFaultRows) all += fmt::format("{}{}", all.empty() ? "" : ", ", row.word);
      throw usage_error(fmt::format("there is no fault '{}'; there are {}", word, all));
    }
    kinds.push_back(*kind);
    from = to + 1;
  }
  return kinds;
}

}  // namespace telekerf::experiments
