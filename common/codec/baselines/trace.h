// SPDX-License-Identifier: Apache-2.0
// A recorded or made-up signal: columns of numbers at one rate.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace telekerf::codec {

struct Trace {
  std::string name;
  std::vector<std::string> columns;         ///< names
  std::vector<std::vector<double>> values;  ///< [column][sample], SI; NaN where a cell says nan
  double rate_hz = 1000.0;

  std::size_t size() const { return values.empty() ? 0 : values.front().size(); }
};

/// CSV with or without a header line ("c1", "c2" ... without); empty lines and lines that begin with # are
/// skipped. `wanted` picks columns by name, empty: all. Throws StartupError that names file, line and cell,
/// also where a float32 does not hold the number.
Trace read_trace(const std::filesystem::path& file, double rate_hz,
                 const std::vector<std::string>& wanted = {});
/// Same layout, full precision. Throws StartupError.
void write_trace(const std::filesystem::path& file, const Trace& trace);

}  // namespace telekerf::codec
