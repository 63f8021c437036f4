// SPDX-License-Identifier: Apache-2.0
// What a figure shows: the curves that gnuplot drew, read out of its SVG, and the rows of its CSV.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/reporting/plot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::reporting {
namespace {

namespace fs = std::filesystem;

fs::path file_named(const std::string& name) {
  return fs::path(testing::TempDir()) / ("plot-" + std::to_string(getpid()) + "-" + name);
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string svg_of(const Figure& figure) {
  draw_figure(figure, file_named("figure.png"));
  return text_of(file_named("figure.svg"));
}

using Stroke = std::vector<cv::Point2d>;

/// The strokes of one colour, without the sample in the legend (a horizontal stroke of two points).
std::vector<Stroke> strokes(const std::string& svg, const std::string& rgb) {
  static const std::regex kPath(
      R"re(<path +stroke='rgb\(([ 0-9,]+)\)' +(?:stroke-dasharray='[^']*' *)? *d='([^']*)')re");
  std::vector<Stroke> found;
  for (std::sregex_iterator at(svg.begin(), svg.end(), kPath), end; at != end; ++at) {
    std::string colour = (*at)[1];
    colour.erase(std::remove(colour.begin(), colour.end(), ' '), colour.end());
    if (colour != rgb) continue;
    std::istringstream numbers(std::regex_replace(std::string((*at)[2]), std::regex("[ML,]"), " "));
    std::string path = (*at)[2];
    std::vector<Stroke> parts;
    std::regex step(R"(([ML])([-0-9.]+),([-0-9.]+))");
    for (std::sregex_iterator s(path.begin(), path.end(), step), none; s != none; ++s) {
      if ((*s)[1] == "M") parts.emplace_back();
      parts.back().emplace_back(std::stod((*s)[2]), std::stod((*s)[3]));
    }
    for (const Stroke& part : parts)
      if (part.size() > 2 || (part.size() == 2 && part[0].y != part[1].y)) found.push_back(part);
  }
  return found;
}

const std::string kBlue = "0,114,178", kOrange = "213,94,0";

TEST(Plot, ALineRunsWhereItsValuesAre) {
  Panel panel;
  panel.lines = {{.x = {0, 1, 2, 2}, .y = {0, 10, 0, 20}}};
  panel.x_range = {{0, 2}};
  panel.y_range = {{0, 20}};
  const auto drawn = strokes(svg_of({.panels = {panel}}), kBlue);
  ASSERT_EQ(drawn.size(), 1u);
  ASSERT_EQ(drawn[0].size(), 4u);
  const Stroke& s = drawn[0];
  EXPECT_NEAR(s[1].x, 0.5 * (s[0].x + s[2].x), 0.2);
  EXPECT_NEAR(s[1].y, 0.5 * (s[2].y + s[3].y), 0.2) << "ten is half way to twenty";
  EXPECT_LT(s[3].y, s[2].y) << "upwards";
}

TEST(Plot, LogarithmicAxesAndGaps) {
  Panel panel;
  panel.lines = {{.x = {1, 10, 100, 100}, .y = {1, 1000, 1, 1e6}}};
  panel.log_x = panel.log_y = true;
  const auto logarithmic = strokes(svg_of({.panels = {panel}}), kBlue);
  ASSERT_EQ(logarithmic.size(), 1u);
  const Stroke& s = logarithmic[0];
  EXPECT_NEAR(s[1].x, 0.5 * (s[0].x + s[2].x), 0.2);
  EXPECT_NEAR(s[1].y, 0.5 * (s[2].y + s[3].y), 0.2);
  panel.log_x = panel.log_y = false;
  panel.lines = {{.x = {0, 1, 2, NAN, 4, 5, 6}, .y = {1, 2, 1, 1, 1, 2, 1}}};
  const auto gap = strokes(svg_of({.panels = {panel}}), kBlue);
  ASSERT_EQ(gap.size(), 2u) << "a NaN leaves a gap";
  EXPECT_EQ(gap[0].size(), 3u);
  EXPECT_LT(gap[0].back().x + 10, gap[1].front().x);
}

TEST(Plot, ASinglePlaceIsSeen) {
  const auto points = [](const Line& line) {
    const std::string svg = svg_of({.panels = {{.lines = {line}}}});
    std::size_t n = 0;
    for (std::size_t at = svg.find("xlink:href='#gpPt", svg.find("</defs>")); at != svg.npos;
         at = svg.find("xlink:href='#gpPt", at + 1))
      ++n;
    return n;
  };
  EXPECT_EQ(points({.x = {1}, .y = {2}}), 1u);
  EXPECT_EQ(points({.x = {1, 2}, .y = {2, 3}}), 0u);
  EXPECT_EQ(points({.x = {1, 2}, .y = {2, 3}, .style = Line::Style::kPoints}), 2u);
}

TEST(Plot, EqualAxesShowACircleRound) {
  Panel panel;
  Line circle;
  for (int i = 0; i <= 360; ++i) {
    circle.x.push_back(3.0 + std::cos(i * M_PI / 180));
    circle.y.push_back(std::sin(i * M_PI / 180));
  }
  panel.lines = {circle};
  const auto roundness = [&] {
    const Stroke s = strokes(svg_of({.panels = {panel}}), kBlue).at(0);
    const auto [left, right] =
        std::minmax_element(s.begin(), s.end(), [](auto& a, auto& b) { return a.x < b.x; });
    const auto [top, bottom] =
        std::minmax_element(s.begin(), s.end(), [](auto& a, auto& b) { return a.y < b.y; });
    return (right->x - left->x) / (bottom->y - top->y);
  };
  EXPECT_GT(roundness(), 1.3) << "the panel is wider than high";
  panel.equal_axes = true;
  EXPECT_NEAR(roundness(), 1.0, 0.02);
}

TEST(Plot, ColoursGoByPlaceOrAsAskedAndDashesAreTold) {
  Panel panel;
  const std::vector<double> x{0, 1, 2}, y{0, 1, 0};
  panel.lines = {{.label = "first", .x = x, .y = y}, {.label = "second", .x = x, .y = y}};
  std::string svg = svg_of({.panels = {panel}});
  EXPECT_EQ(strokes(svg, kBlue).size(), 1u);
  EXPECT_EQ(strokes(svg, kOrange).size(), 1u);
  const auto dashes = [](const std::string& drawing) {
    std::size_t n = 0;
    for (std::size_t at = drawing.find("stroke-dasharray"); at != drawing.npos;
         at = drawing.find("stroke-dasharray", at + 1))
      ++n;
    return n;
  };
  const std::size_t before = dashes(svg);
  panel.lines[0].colour = 9;  // colours go round
  panel.lines[1].style = Line::Style::kDashed;
  svg = svg_of({.panels = {panel}});
  EXPECT_EQ(strokes(svg, kBlue).size(), 0u);
  EXPECT_GT(dashes(svg), before);
}

TEST(Plot, TitlesLabelsAndLegendAreWrittenAsTheyAre) {
  Panel panel{.title = "it's a_b^c", .x_label = "along [mm]", .y_label = "error [um]"};
  panel.lines = {{.label = "the \"tool\"", .x = {0, 1}, .y = {0, 1}}, {.x = {0, 1}, .y = {1, 0}}};
  const std::string svg = svg_of({.title = "a {figure}", .panels = {panel}});
  for (const char* words : {"it's a_b^c", "along [mm]", "error [um]", "a {figure}"})
    EXPECT_NE(svg.find(words), svg.npos) << words;
  EXPECT_TRUE(svg.find("the \"tool\"") != svg.npos || svg.find("the &quot;tool&quot;") != svg.npos);
}

TEST(Plot, ThePicturesSizeIsThePanels) {
  const auto png = file_named("size.png");
  draw_figure({.title = "t",
               .panels = std::vector<Panel>(5),
               .columns = 2,
               .panel_width_px = 300,
               .panel_height_px = 200},
              png);
  EXPECT_EQ(cv::imread(png.string()).size(), cv::Size(600, 634));
  draw_figure({.panels = std::vector<Panel>(2), .columns = 2}, png);
  EXPECT_EQ(cv::imread(png.string()).size(), cv::Size(960, 320));
}

TEST(Plot, APanelMayShowAPicture) {
  const auto picture = file_named("it's a picture.png");
  cv::imwrite(picture.string(), cv::Mat(60, 60, CV_8UC3, cv::Scalar(20, 30, 250)));
  const auto png = file_named("with-picture.png");
  draw_figure({.panels = {{.title = "red", .picture = picture}}}, png);
  const cv::Mat drawn = cv::imread(png.string());
  EXPECT_EQ(drawn.at<cv::Vec3b>(drawn.rows / 2, drawn.cols / 2), cv::Vec3b(20, 30, 250));
}

TEST(Plot, OfAPictureThatIsLargerThanItsPanelNoLineIsLeftOut) {
  constexpr int kLines = 20, kApart = 97;
  cv::Mat fine(2000, 2000, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int n = 1; n <= kLines; ++n)
    cv::line(fine, {n * kApart, 0}, {n * kApart, 1999}, cv::Scalar(0, 0, 0), 3);
  const auto picture = file_named("fine.png"), png = file_named("fine-in-a-panel.png");
  cv::imwrite(picture.string(), fine);
  draw_figure({.panels = {{.picture = picture}}}, png);
  cv::Mat grey;
  cv::cvtColor(cv::imread(png.string()), grey, cv::COLOR_BGR2GRAY);
  const cv::Mat row = grey.row(grey.rows / 2);
  int dark = 0;
  for (int x = 1; x < row.cols; ++x) dark += row.at<uchar>(x) < 250 && row.at<uchar>(x - 1) >= 250 ? 1 : 0;
  EXPECT_EQ(dark, kLines);
  EXPECT_FALSE(fs::exists(file_named("fine-in-a-panel.panel-0.png"))) << "what was made for it is gone";
}

TEST(Plot, APictureMayHaveAxes) {
  const auto picture = file_named("halves.png");
  cv::Mat halves(50, 100, CV_8UC3, cv::Scalar(20, 30, 250));
  halves.rowRange(25, 50).setTo(cv::Scalar(250, 30, 20));
  cv::imwrite(picture.string(), halves);
  const Figure figure{
      .panels = {{.x_range = std::array{8.0, 22.0}, .y_range = std::array{0.0, 40.0}, .picture = picture}}};
  const std::string script = gnuplot_script(figure);
  EXPECT_NE(script.find("set xrange [8:22]\nset yrange [0:40]\n"), script.npos);
  EXPECT_NE(script.find("origin=(8.07,0.4) dx=0.14 dy=0.8 with rgbimage"), script.npos) << script;
  const auto png = file_named("halves-in-a-panel.png");
  draw_figure(figure, png);
  const cv::Mat drawn = cv::imread(png.string());
  EXPECT_EQ(drawn.at<cv::Vec3b>(drawn.rows / 4, drawn.cols / 2), cv::Vec3b(20, 30, 250)) << "its upper half";
  EXPECT_EQ(drawn.at<cv::Vec3b>(drawn.rows * 3 / 4, drawn.cols / 2), cv::Vec3b(250, 30, 20));
}

TEST(Plot, TheSameFigureLeavesTheSameBytes) {
  const Figure figure{.panels = {{.title = "a", .lines = {{.x = {0, 1}, .y = {0, 1}}}}}};
  draw_figure(figure, file_named("a.png"));
  draw_figure(figure, file_named("b.png"));
  for (const char* kind : {"png", "svg", "csv"})
    EXPECT_EQ(text_of(file_named(std::string("a.") + kind)), text_of(file_named(std::string("b.") + kind)))
        << kind;
}

TEST(Plot, TheDataStandInTheCsv) {
  Figure figure{.panels = {{.title = "speed, \"true\"", .x_label = "time [s]", .y_label = "[mm/s]"}}};
  figure.panels[0].lines = {{.label = "tool", .x = {0.5, 1}, .y = {-2, 1e-7}}, {.x = {0}, .y = {3}}};
  EXPECT_EQ(figure_csv(figure),
            "panel,x_axis,y_axis,line,x,y\n"
            "\"speed, \"\"true\"\"\",\"time [s]\",\"[mm/s]\",\"tool\",0.5,-2\n"
            "\"speed, \"\"true\"\"\",\"time [s]\",\"[mm/s]\",\"tool\",1,1e-07\n"
            "\"speed, \"\"true\"\"\",\"time [s]\",\"[mm/s]\",\"[mm/s], 2\",0,3\n");
  figure.panels[0].lines = {{.x = {0}, .y = {3}}};
  EXPECT_NE(figure_csv(figure).find("\"[mm/s]\",\"[mm/s]\",0,3\n"), std::string::npos) << "the only one";
}

/// What is said where the folder is where programs are looked for first.
std::string complaint_with(const fs::path& folder, const Figure& figure, const fs::path& png) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.string() + ":/usr/bin:/bin").c_str(), 1);
  std::string said;
  try {
    draw_figure(figure, png);
  } catch (const StartupError& error) {
    said = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  return said;
}

/// A program that stands in for gnuplot.
fs::path folder_with_gnuplot(const std::string& lines) {
  const fs::path folder = file_named("programs");
  fs::create_directories(folder);
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\n" << lines << "\n";
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  return folder;
}

TEST(Plot, WhatGnuplotSaysIsInTheError) {
  const std::string said =
      complaint_with("/nowhere", {.panels = std::vector<Panel>(1)}, "/nowhere/at/all.png");
  EXPECT_TRUE(said.starts_with("/nowhere/at/all.png: gnuplot ended with code 1, and said: line ")) << said;
  EXPECT_NE(said.find(": cannot open file; output not changed; system error: No such file or directory;"),
            said.npos)
      << said;
}

TEST(Plot, WhereThereIsNoGnuplotItIsSaid) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  EXPECT_THROW(draw_figure({.panels = std::vector<Panel>(1)}, file_named("never.png")), StartupError);
  std::string said;
  try {
    draw_figure({.panels = std::vector<Panel>(1)}, file_named("never.png"));
  } catch (const StartupError& error) {
    said = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(said.find("install gnuplot-nox"), said.npos) << said;
}

TEST(Plot, AFigureThatIsNotDrawnToItsEndIsNoFigure) {
  const Figure figure{.panels = {{.title = "a", .lines = {{.x = {0, 1}, .y = {0, 1}}}}}};
  const fs::path png = file_named("half.png");
  draw_figure(figure, png);
  const std::string whole = text_of(png);
  // It ends well and has drawn nothing, nothing at all, or half of it; what was there before does not count.
  const std::string file = "'" + png.string() + "'";
  for (const std::string& lines : {std::string("exit 0"), ": > " + file, "echo some of it > " + file}) {
    std::ofstream(png, std::ios::binary) << whole;
    const std::string said = complaint_with(folder_with_gnuplot("cat > /dev/null; " + lines), figure, png);
    EXPECT_NE(said.find("half.png: gnuplot has not drawn it to its end, and said nothing"), said.npos)
        << lines << ": " << said;
  }
  const std::string said = complaint_with(folder_with_gnuplot("echo no room >&2; kill -9 $$"), figure, png);
  EXPECT_NE(said.find("gnuplot was ended by signal 9, and said: no room"), said.npos) << said;
}

}  // namespace
}  // namespace telekerf::reporting
