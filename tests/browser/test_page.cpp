// SPDX-License-Identifier: Apache-2.0
// The console's page in a real browser: test_page.py says what is done there.
#include <gtest/gtest.h>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

TEST(Page, APersonCutsAndThePageLetsGoWheneverItShould) {
  Program test(TELEKERF_PYTHON, {TELEKERF_PAGE_TEST, TELEKERF_BIN_DIR, TELEKERF_SCREENSHOTS, own_domain()});
  EXPECT_EQ(test.wait(std::chrono::seconds(100)), 0) << test.output();
}

}  // namespace
}  // namespace telekerf::integration
