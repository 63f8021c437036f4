// SPDX-License-Identifier: Apache-2.0
// The console's page in a real browser: the Python files say what is done there.
#include <gtest/gtest.h>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

/// What it says is good, or the figures of what is not.
void expect_good(const std::string& test) {
  Program run(TELEKERF_PYTHON,
              {TELEKERF_BROWSER_TESTS + ("/" + test), TELEKERF_BIN_DIR, TELEKERF_SCREENSHOTS, own_domain()});
  const int code = run.wait(std::chrono::seconds(240));
  if (code == -1) {  // it ends what it has started
    run.interrupt();
    (void)run.wait(std::chrono::seconds(20));
  }
  EXPECT_EQ(code, 0) << run.output();
}

TEST(Page, APersonCutsAndThePageLetsGoWheneverItShould) { expect_good("test_page.py"); }
TEST(Page, PlaysRecordedRunsAndGivesTheirFiles) { expect_good("test_playback.py"); }

}  // namespace
}  // namespace telekerf::integration
