// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/runtime/startup_error.h"
#include "slave/vision/imaging/imaging_file.h"

namespace telekerf::imaging {
namespace {

std::string refusal(const std::string& toml) {
  try {
    parse_imaging(toml, "unit.toml");
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

TEST(ImagingFile, EmptyIsTheDefaultUnit) {
  const ImagingFile file = parse_imaging("", "unit.toml");
  EXPECT_EQ(file.model.log_scale, ImagingModel{}.log_scale);
  EXPECT_EQ(file.axes[kFocus].backlash_m, default_axes()[kFocus].backlash_m);
}

TEST(ImagingFile, ThatHasLostItsFiguresIsRefused) {
  const auto path = std::filesystem::path(testing::TempDir()) / ("telekerf-unit-" + std::to_string(::getpid()) + ".toml");
  for (const char* left : {"", "# An imaging unit\n", "[optics]\n"}) {
    std::ofstream(path) << left;
    try {
      (void)load_imaging(path.string());
      ADD_FAILURE() << left;
    } catch (const StartupError& error) {
      EXPECT_NE(std::string(error.what()).find("is empty, or has lost its figures"), std::string::npos) << error.what();
    }
  }
  std::ofstream(path) << imaging_toml(default_imaging());
  EXPECT_EQ(load_imaging(path.string()).model.log_scale, default_imaging().model.log_scale);
  std::filesystem::remove(path);
}

TEST(ImagingFile, IsReadBackFigureByFigure) {
  ImagingFile file;
  file.model.optics.numerical_aperture = 0.08;
  file.model.optics.sharpest_px = 0.71;
  file.model.log_scale = {-10.123456789012345, -0.9, 1e-3, -2e-5};
  file.model.ridge_m = {0.0123, 0.0045, -0.0026};
  file.model.focus_scale_per_m = 1.25;
  file.model.distortion = -0.0125;
  file.model.flat_field = {1e-3, -2e-3, -0.2, 0.04};
  file.axes[kMagnification].travel_m = file.model.magnification_travel_m = 0.07;
  file.axes[kFocus].travel_m = file.model.focus_travel_m = 0.025;
  file.axes[kFocus].backlash_m = 0.3e-3;
  file.axes[kFocus].peak_force_n = 17.0;
  const ImagingFile back = parse_imaging(imaging_toml(file), "unit.toml");
  EXPECT_EQ(back.model.optics.numerical_aperture, 0.08);
  EXPECT_EQ(back.model.optics.sharpest_px, 0.71);
  EXPECT_EQ(back.model.log_scale, file.model.log_scale);
  EXPECT_EQ(back.model.ridge_m, file.model.ridge_m);
  EXPECT_EQ(back.model.focus_scale_per_m, 1.25);
  EXPECT_EQ(back.model.distortion, -0.0125);
  EXPECT_EQ(back.model.flat_field, file.model.flat_field);
  EXPECT_EQ(back.model.magnification_travel_m, 0.07);
  EXPECT_EQ(back.model.focus_travel_m, 0.025);
  EXPECT_EQ(back.axes[kFocus].backlash_m, 0.3e-3);
  EXPECT_EQ(back.axes[kFocus].peak_force_n, 17.0);
  EXPECT_EQ(imaging_toml(back), imaging_toml(file));
}

TEST(ImagingFile, RefusesWhatItDoesNotKnow) {
  EXPECT_NE(refusal("[optics]\naperture = 0.1\n").find("optics.aperture"), std::string::npos);
  EXPECT_NE(refusal("[focus]\nbacklash_m = 0.5\n").find("focus.backlash_m"), std::string::npos);
  EXPECT_NE(refusal("[coupling]\nridge_m = [0.01, 0.02]\n").find("coupling.ridge_m"), std::string::npos);
  EXPECT_NE(refusal("[picture]\ndistortion = 0.9\n").find("picture.distortion"), std::string::npos);
  EXPECT_THROW(load_imaging("no-such-unit.toml"), StartupError);
}

TEST(ImagingFile, RefusesWhatIsOfAnotherUnitOrInOtherUnits) {
  // Micrometres instead of the logarithm of metres; millimetres instead of metres.
  EXPECT_EQ(refusal("[coupling]\nlog_scale = [25, 0, 0, 0]\n"),
            "unit.toml: coupling.log_scale = [25, 0, 0, 0]: makes a pixel 7.20049e+10 m wide where the "
            "magnification is at 0 of its travel; it must lie within [1e-08, 0.01] m; calibrate anew");
  EXPECT_NE(refusal("[coupling]\nlog_scale = [-10.6, -9, 0, 0]\n").find("at 1 of its travel"),
            std::string::npos);
  EXPECT_NE(refusal("[coupling]\nlog_scale = [-10.6, 0, 0, 99]\n").find("coupling.log_scale"),
            std::string::npos);
  EXPECT_EQ(
      refusal("[coupling]\nridge_m = [13, 6, -3]\n"),
      "unit.toml: coupling.ridge_m = [13, 6, -3]: puts the focus at 13 m where the magnification is at 0 "
      "of its travel; the travel is [0, 0.03] m; calibrate anew");
  EXPECT_NE(refusal("[coupling]\nridge_m = [0.01, -0.05, 0]\n").find("puts the focus at -0.04 m"),
            std::string::npos);
  EXPECT_NE(refusal("[picture]\nflat_field = [0, 0, -0.8, 0]\n")
                .find("picture.flat_field = [0, 0, -0.8, 0]: leaves -0.2"),
            std::string::npos)
      << refusal("[picture]\nflat_field = [0, 0, -0.8, 0]\n");
  EXPECT_NE(refusal("[picture]\nflat_field = [0, 1.4, 0, 0]\n").find("picture.flat_field"),
            std::string::npos);
  // Steep, but of a lens that there is.
  EXPECT_EQ(refusal("[picture]\nflat_field = [0.1, 0, -0.5, 0]\n[coupling]\nridge_m = [-0.005, 0.04, 0]\n"),
            "");
}

}  // namespace
}  // namespace telekerf::imaging
