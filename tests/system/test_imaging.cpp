// SPDX-License-Identifier: Apache-2.0
// telekerf-vision with an imaging unit: calibrated, in focus, zoomed; and the axes of docs/how-to in Python.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/axes_runner.h"
#include "slave/vision/imaging/imaging_file.h"
#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

TEST(Imaging, IsCalibratedAndThenKeepsContourAndScaleThroughAZoom) {
  const std::string unit = (Program::scratch() / "unit.toml").string();
  {
    Program calibration("telekerf-vision", {"--imaging", "simulated", "--calibrate", unit});
    ASSERT_EQ(calibration.wait(seconds(100)), 0) << calibration.output();
    const std::string said = calibration.output(), word = "calibrated to ";
    ASSERT_NE(said.find(word), std::string::npos) << said;
    const double percent = std::stod(said.substr(said.find(word) + word.size()));
    EXPECT_GT(percent, 0.001) << said;
    EXPECT_LT(percent, 0.1) << said;
  }
  EXPECT_NEAR(imaging::load_imaging(unit).model.distortion, -0.01, 1e-3);

  Program vision("telekerf-vision", {"--domain", own_domain(), "--cell", "imaging", "--imaging", "simulated",
                                     "--imaging-file", unit, "--image", "gear", "--zoom", "0.05"});
  ASSERT_TRUE(vision.says("in focus", seconds(60))) << vision.output();
  ASSERT_TRUE(vision.says("mm a pixel", seconds(60))) << vision.output();
  const std::string first = vision.output();
  Program zoom("telekerf-ctl", {"zoom", "0.25", "--domain", own_domain(), "--cell", "imaging"});
  EXPECT_EQ(zoom.wait(seconds(30)), 0) << zoom.output();
  // Published anew: twice the line that ends so.
  bool again = false;
  for (int i = 0; i < 600 && !again; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    again = vision.output().find("mm a pixel", first.find("mm a pixel") + 1) != std::string::npos;
  }
  EXPECT_TRUE(again) << vision.output();
  EXPECT_TRUE(vision.running());
  vision.interrupt();
  EXPECT_EQ(vision.wait(seconds(20)), 0) << vision.output();
}

TEST(Imaging, ACalibrationThatCannotBeIsRefusedAtOnce) {
  Program nothing("telekerf-vision", {"--calibrate", (Program::scratch() / "none.toml").string()});
  EXPECT_EQ(nothing.wait(seconds(40)), 2) << nothing.output();
  EXPECT_TRUE(
      nothing.says("--imaging must say which axes are calibrated: simulated, udp:HOST:PORT", seconds(1)))
      << nothing.output();
  const std::filesystem::path file = Program::scratch() / "no-folder";
  std::ofstream(file) << "a file";
  Program nowhere("telekerf-vision",
                  {"--imaging", "simulated", "--calibrate", (file / "unit.toml").string()});
  EXPECT_EQ(nowhere.wait(seconds(40)), 2) << nowhere.output();
  EXPECT_TRUE(nowhere.says("no-folder is no folder", seconds(1))) << nowhere.output();
  Program folder("telekerf-vision", {"--imaging", "simulated", "--calibrate", Program::scratch().string()});
  EXPECT_EQ(folder.wait(seconds(40)), 2) << folder.output();
  EXPECT_TRUE(folder.says("is a folder; name the file to be written in it", seconds(1))) << folder.output();
}

TEST(Imaging, AFileOfAnotherUnitIsRefused) {
  const std::filesystem::path file = Program::scratch() / "other.toml";
  std::ofstream(file) << "[coupling]\nlog_scale = [25, -9, 0, 0]\n";
  Program vision("telekerf-vision", {"--imaging", "simulated", "--imaging-file", file.string()});
  EXPECT_EQ(vision.wait(seconds(40)), 2) << vision.output();
  EXPECT_TRUE(vision.says("other.toml: coupling.log_scale = [25, -9, 0, 0]: makes a pixel", seconds(1)))
      << vision.output();
}

TEST(Imaging, AxesOfYoursWantALiveCamera) {
  Program vision("telekerf-vision", {"--imaging", "udp:127.0.0.1:9"});
  EXPECT_EQ(vision.wait(seconds(40)), 2) << vision.output();
  EXPECT_TRUE(vision.says("--camera must say", seconds(1))) << vision.output();
  Program files("telekerf-vision", {"--imaging", "udp:127.0.0.1:9", "--camera", "folder:pictures"});
  EXPECT_EQ(files.wait(seconds(40)), 2) << files.output();
  EXPECT_TRUE(files.says("--camera folder:pictures shows files", seconds(1))) << files.output();
}

TEST(Imaging, WhatNothingReadsIsRefused) {
  const auto refused = [](const std::vector<std::string>& words, const std::string& sentence) {
    Program vision("telekerf-vision", words);
    EXPECT_EQ(vision.wait(seconds(40)), 2) << vision.output();
    EXPECT_TRUE(vision.says(sentence, seconds(1))) << vision.output();
  };
  refused({"--imaging", "simulated", "--camera", "0"}, "camera has no effect with imaging = simulated");
  refused({"--zoom", "0.6"}, "zoom has no effect with imaging = none");
  refused({"--law", "thesis"}, "law has no effect with imaging = none");
  refused({"--focus-region", "0.5"}, "focus_region has no effect with imaging = none");
  refused({"--imaging-file", "unit.toml"}, "imaging_file has no effect with imaging = none");
}

#ifdef TELEKERF_AXES_EXAMPLE
TEST(AxesExample, HomesAndGoesWhereItIsSent) {
  Program example(TELEKERF_PYTHON, {TELEKERF_AXES_EXAMPLE, "--port", "0"});
  const std::string before = "axes: udp:127.0.0.1:";
  ASSERT_TRUE(example.says(before, seconds(20)) && example.says("\n", seconds(1))) << example.output();
  const std::string port =
      std::to_string(std::stoi(example.output().substr(example.output().find(before) + before.size())));
  const imaging::AxesModel model = imaging::default_axes();
  imaging::AxesRunner runner(imaging::open_axes("udp:127.0.0.1:" + port, {.model = model, .period_s = 1e-3}),
                             model);
  runner.start();
  const auto within = [&](auto condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return condition();
  };
  // On a busy machine answers come late; the axes then stand, and go on or home anew, as the page says.
  ASSERT_TRUE(within([&] { return runner.state() == imaging::AxesControl::State::kReady; }));
  runner.approach(imaging::kFocus, 0.012);
  ASSERT_TRUE(within([&] { return runner.settled(imaging::kFocus); }));
  EXPECT_NEAR(runner.positions_m().focus_m, 0.012, 20e-6);
}
#endif

}  // namespace
}  // namespace telekerf::integration
