// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/trace.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::size_t begin = 0;
  while (true) {
    const auto end = line.find_first_of(",;\t", begin);
    auto cell = line.substr(begin, end == std::string::npos ? end : end - begin);
    const auto first = cell.find_first_not_of(' ');
    const auto last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    if (end == std::string::npos) return cells;
    begin = end + 1;
  }
}

std::optional<double> number_in(const std::string& cell) {
  if (cell.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (*end != '\0') return std::nullopt;
  return value;
}

}  // namespace

Trace read_trace(const std::filesystem::path& file, double rate_hz, const std::vector<std::string>& wanted) {
  std::ifstream in(file);
  if (!in) throw input_error(fmt::format("{}: cannot be read", file.string()));
  Trace all;
  all.name = file.stem().string();
  all.rate_hz = rate_hz;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r" || line[0] == '#') continue;
    const auto cells = cells_of(line);
    if (all.columns.empty()) {
      const bool header =
          std::none_of(cells.begin(), cells.end(), [](const auto& cell) { return number_in(cell); });
      for (std::size_t c = 0; c < cells.size(); ++c) {
        all.columns.push_back(header ? cells[c] : fmt::format("c{}", c + 1));
      }
      all.values.resize(cells.size());
      if (header) continue;
    }
    if (cells.size() != all.columns.size()) {
      throw input_error(fmt::format("{}: line {}: {} cells where the first line has {}", file.string(),
                                    number, cells.size(), all.columns.size()));
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto value = number_in(cells[c]);
      if (!value) {
        throw input_error(fmt::format("{}: line {}: '{}' is not a number", file.string(), number, cells[c]));
      }
      if (!(std::abs(*value) <= std::numeric_limits<float>::max())) {
        throw input_error(fmt::format("{}: line {}: '{}' is beyond what a float32 holds, +-3.4e38",
                                      file.string(), number, cells[c]));
      }
      all.values[c].push_back(*value);
    }
  }
  if (all.size() == 0) throw input_error(fmt::format("{}: holds no numbers", file.string()));
  if (wanted.empty()) return all;

  Trace picked{all.name, {}, {}, rate_hz};
  for (const auto& name : wanted) {
    const auto found = std::find(all.columns.begin(), all.columns.end(), name);
    if (found == all.columns.end()) {
      throw input_error(
          fmt::format("{}: no column '{}'; it has {}", file.string(), name, fmt::join(all.columns, ", ")));
    }
    picked.columns.push_back(name);
    picked.values.push_back(all.values[static_cast<std::size_t>(found - all.columns.begin())]);
  }
  return picked;
}

void write_trace(const std::filesystem::path& file, const Trace& trace) {
  std::string out = fmt::format("{}\n", fmt::join(trace.columns, ","));
  std::vector<double> row(trace.values.size());
  for (std::size_t n = 0; n < trace.size(); ++n) {
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = trace.values[c][n];
    out += fmt::format("{}\n", fmt::join(row, ","));
  }
  write_atomically(file, out);
}

}  // namespace telekerf::codec
