// SPDX-License-Identifier: Apache-2.0
// Panels over time out of a figure's CSV, packed so that the page has more points of them than their picture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace telekerf::experiments {

struct TimedLine {
  std::string label;
  std::vector<double> x, y;
};
struct TimedPanel {
  std::string title, x_axis, y_axis;
  std::vector<TimedLine> lines;
};

/// Those panels of a figure_csv() whose x axis is a time; none if there is no such file.
std::vector<TimedPanel> timed_panels(const std::filesystem::path& csv);

/// Of each of so many stretches its least and its largest, so that no peak is lost.
TimedLine thinned(const TimedLine& line, std::size_t stretches);

/// `x`, `y`: names of the axes; `lines`: of each its label, `n` points and the ranges `x_range` and
/// `y_range`; `data`: all lines' points, one line behind the other, first every x, then every y: 16 bits of
/// their range, each as its difference to the one before, first all low bytes, then all high ones; deflated
/// (zlib), base64. An x is off by at most a 130,000th, a y by a 130,000th of its range.
nlohmann::ordered_json plot_data(const TimedPanel& panel);

/// As text for an address or a script.
std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace telekerf::experiments
