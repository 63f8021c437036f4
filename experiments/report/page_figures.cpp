// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/page_figures.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/runtime/startup_error.h"
#include "experiments/report/plot_data.h"

namespace telekerf::experiments {
namespace fs = std::filesystem;

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
  const cv::Mat picture = cv::imread(png.string(), cv::IMREAD_COLOR);
  if (picture.empty())
    throw input_error(png.string() + ": is no picture; the experiment should have left it");
  const auto coded = [](const cv::Mat& drawn, int quality) {
    std::vector<unsigned char> bytes;
    cv::imencode(".webp", drawn, bytes, {cv::IMWRITE_WEBP_QUALITY, quality});
    return bytes;
  };
  constexpr int kQuality = 20, kLossless = 101;
  if (picture.cols > width_px) {
    cv::Mat small;
    cv::resize(picture, small, {width_px, picture.rows * width_px / picture.cols}, 0, 0, cv::INTER_AREA);
    return "data:image/webp;base64," + base64(coded(small, kQuality));
  }
  // Few lines on much white are smaller as they are.
  const auto lossy = coded(picture, kQuality), whole = coded(picture, kLossless);
  return "data:image/webp;base64," + base64(whole.size() < lossy.size() ? whole : lossy);
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
