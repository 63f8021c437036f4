// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/plot_data.h"

#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

/// Some of them are a pixel of the still picture.
constexpr std::size_t kStretches = 600;

/// A line of figure_csv(): four quoted fields and two numbers.
struct CsvRow {
  std::string panel, x_axis, y_axis, line;
  double x = 0.0, y = 0.0;
};

std::string take_quoted(const std::string& text, std::size_t& at) {
  std::string out;
  for (++at; at < text.size(); ++at) {
    if (text[at] == '"' && (at + 1 == text.size() || text[at + 1] != '"')) break;
    if (text[at] == '"') ++at;
    out += text[at];
  }
  at += 2;  // the quote and the comma
  return out;
}

CsvRow row_of(const std::string& text) {
  CsvRow row;
  std::size_t at = 0;
  for (std::string* field : {&row.panel, &row.x_axis, &row.y_axis, &row.line}) *field = take_quoted(text, at);
  const std::size_t comma = text.find(',', at);
  if (comma == text.npos) return row;
  row.x = std::strtod(text.c_str() + at, nullptr);
  row.y = std::strtod(text.c_str() + comma + 1, nullptr);
  return row;
}

/// A line of one value has a range all the same.
std::array<double, 2> range_of(const std::vector<double>& values) {
  if (values.empty()) return {0.0, 1.0};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high > *low ? *high : *low + 1.0};
}

void put(const std::vector<double>& values, const std::array<double, 2>& range,
         std::vector<unsigned char>& bytes) {
  std::vector<std::uint16_t> steps;
  std::uint16_t before = 0;
  for (const double value : values) {
    const auto now =
        static_cast<std::uint16_t>(std::lround(65535.0 * (value - range[0]) / (range[1] - range[0])));
    steps.push_back(static_cast<std::uint16_t>(now - before));
    before = now;
  }
  for (const int shift : {0, 8})
    for (const std::uint16_t step : steps) bytes.push_back(static_cast<unsigned char>(step >> shift));
}

std::vector<unsigned char> deflated(const std::vector<unsigned char>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<unsigned char> out(size);
  if (compress2(out.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK)
    throw environment_error("report page: no memory to pack the plots; close something else");
  out.resize(size);
  return out;
}

}  // namespace

std::vector<TimedPanel> timed_panels(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::vector<TimedPanel> panels;
  std::string text;
  std::getline(in, text);  // the head
  while (std::getline(in, text)) {
    const CsvRow row = row_of(text);
    if (!row.x_axis.starts_with("time") || !std::isfinite(row.x) || !std::isfinite(row.y)) continue;
    if (panels.empty() || panels.back().title != row.panel || panels.back().y_axis != row.y_axis)
      panels.push_back({row.panel, row.x_axis, row.y_axis, {}});
    auto& lines = panels.back().lines;
    if (lines.empty() || lines.back().label != row.line) lines.push_back({row.line, {}, {}});
    lines.back().x.push_back(row.x);
    lines.back().y.push_back(row.y);
  }
  return panels;
}

TimedLine thinned(const TimedLine& line, std::size_t stretches) {
  if (line.x.size() <= 2 * stretches) return line;
  TimedLine out{line.label, {}, {}};
  for (std::size_t k = 0; k < stretches; ++k) {
    const auto from = line.y.begin() + static_cast<std::ptrdiff_t>(k * line.y.size() / stretches);
    const auto to = line.y.begin() + static_cast<std::ptrdiff_t>((k + 1) * line.y.size() / stretches);
    auto [low, high] = std::minmax_element(from, to);
    if (high < low) std::swap(low, high);
    for (const auto& at : {low, high}) {
      const auto i = static_cast<std::size_t>(at - line.y.begin());
      if (!out.x.empty() && out.x.back() >= line.x[i]) continue;
      out.x.push_back(line.x[i]);
      out.y.push_back(line.y[i]);
    }
  }
  return out;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  std::vector<unsigned char> text(4 * (bytes.size() / 3 + 1) + 1);  // and the zero that ends it
  const int length = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return {text.begin(), text.begin() + length};
}

ordered_json plot_data(const TimedPanel& panel) {
  ordered_json lines = ordered_json::array();
  std::vector<unsigned char> bytes;
  for (const TimedLine& whole : panel.lines) {
    const TimedLine line = thinned(whole, kStretches);
    const auto x_range = range_of(line.x), y_range = range_of(line.y);
    put(line.x, x_range, bytes);
    put(line.y, y_range, bytes);
    lines.push_back(
        {{"label", line.label}, {"n", line.x.size()}, {"x_range", x_range}, {"y_range", y_range}});
  }
  return {{"x", panel.x_axis}, {"y", panel.y_axis}, {"lines", lines}, {"data", base64(deflated(bytes))}};
}

}  // namespace telekerf::experiments
