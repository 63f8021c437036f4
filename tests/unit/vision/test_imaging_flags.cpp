// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging_flags.h"

#include <gtest/gtest.h>

namespace telekerf::vision_process {
namespace {

TEST(ImagingFlags, WarnOfRealAxesWithoutTheirFile) {
  ImagingFlags flags;
  EXPECT_EQ(flags.warning(), "");
  flags.imaging = "simulated";
  EXPECT_EQ(flags.warning(), "");
  flags.imaging = "udp:192.0.2.1:7000";
  EXPECT_EQ(flags.warning(),
            "warning: without --imaging-file the simulated unit's scale is taken for this one's, and what is cut has "
            "another size than it shows; calibrate with --calibrate FILE and name that file");
  flags.imaging_file = "unit.toml";
  EXPECT_EQ(flags.warning(), "");
}

}  // namespace
}  // namespace telekerf::vision_process
