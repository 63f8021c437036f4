// SPDX-License-Identifier: Apache-2.0
#include "common/recording/columns.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <iterator>

#include "common/runtime/startup_error.h"

namespace telekerf::columns_detail {

void append(std::string& text, const char* format, double value) {
  fmt::format_to(std::back_inserter(text), fmt::runtime(format), value);
}

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  const char* at = line.data();
  const char* const end = at + line.size();
  while (at < end) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) break;
    numbers.push_back(value);
    at = next < end && *next == ',' ? next + 1 : end;
  }
  return numbers;
}

std::vector<std::string> lines_of(const std::filesystem::path& file, std::string_view header) {
  std::ifstream in(file);
  if (!in)
    throw input_error(
        fmt::format("{}: cannot be read; is this the folder of a finished run?", file.string()));
  std::string line;
  if (!std::getline(in, line) || line != header)
    throw input_error(fmt::format("{}: line 1 must be '{}'", file.string(), header));
  std::vector<std::string> lines;
  while (std::getline(in, line)) lines.push_back(line);
  return lines;
}

void refuse_line(const std::filesystem::path& file, std::size_t line, std::size_t columns) {
  throw input_error(fmt::format("{}: line {} must hold {} numbers", file.string(), line, columns));
}

}  // namespace telekerf::columns_detail
