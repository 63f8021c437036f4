// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/page_figures.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

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

struct TimedLine {
  std::string label;
  std::vector<double> x, y;
};
struct TimedPanel {
  std::string title, x_axis, y_axis;
  std::vector<TimedLine> lines;
};

std::vector<TimedPanel> timed_panels(const fs::path& csv) {
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

/// The least and the largest of each stretch, so that no peak is lost.
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

/// Four digits are more than a screen shows.
double rounded(double value) {
  double out = value;
  const std::string text = fmt::format("{:.4g}", value);
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

nlohmann::ordered_json plot_data(const TimedPanel& panel) {
  nlohmann::ordered_json data{{"x", panel.x_axis}, {"y", panel.y_axis}, {"labels", {panel.x_axis}}};
  std::map<double, std::vector<double>> rows;
  for (std::size_t n = 0; n < panel.lines.size(); ++n) {
    const TimedLine line = thinned(panel.lines[n], 120);
    data["labels"].push_back(line.label);
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      auto& row = rows[rounded(line.x[i])];
      row.resize(panel.lines.size(), NAN);
      row[n] = line.y[i];
    }
  }
  for (const auto& [x, values] : rows) {
    nlohmann::ordered_json row{x};
    for (const double y : values)
      row.push_back(std::isfinite(y) ? nlohmann::ordered_json(rounded(y)) : nlohmann::ordered_json());
    data["rows"].push_back(row);
  }
  return data;
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string picture_address(const fs::path& png, int width_px) {
  cv::Mat picture = cv::imread(png.string(), cv::IMREAD_COLOR);
  if (picture.empty())
    throw input_error(png.string() + ": is no picture; the experiment should have left it");
  if (picture.cols > width_px)
    cv::resize(picture, picture, {width_px, picture.rows * width_px / picture.cols}, 0, 0, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  cv::imencode(".webp", picture, bytes, {cv::IMWRITE_WEBP_QUALITY, 36});
  std::vector<unsigned char> text(4 * (bytes.size() / 3 + 1) + 1);  // and the zero that ends it
  const int length = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return "data:image/webp;base64," + std::string(text.begin(), text.begin() + length);
}

std::string zoomable_panels(const fs::path& png) {
  std::string out;
  for (const TimedPanel& panel : timed_panels(fs::path(png).replace_extension(".csv"))) {
    std::string data = plot_data(panel).dump();
    // What ends a script may not stand in it.
    for (std::size_t at = data.find("</"); at != data.npos; at = data.find("</", at))
      data.replace(at, 2, "<\\/");
    out += fmt::format(
        "<details data-plot><summary>zoom: {}</summary><div class=\"plot\"></div>"
        "<script type=\"application/json\">{}</script></details>\n",
        html_text(panel.title), data);
  }
  return out;
}

}  // namespace telekerf::experiments
