// SPDX-License-Identifier: Apache-2.0
// On what is no terminal: whole lines, each once.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "common/runtime/status_reporter.h"

namespace telekerf {
namespace {

template <typename Use>
std::string said_by(const Use& use, const char* initial = nullptr) {
  testing::internal::CaptureStdout();
  {
    StatusReporter status("slave", initial);
    use(status);
  }
  return testing::internal::GetCapturedStdout();
}

void a_moment() { std::this_thread::sleep_for(std::chrono::milliseconds(300)); }

TEST(StatusReporter, SaysAStateWhenItChanges) {
  EXPECT_EQ(said_by(
                [](StatusReporter& status) {
                  status.say("ready in cell-1");
                  status.state("waiting");
                  a_moment();
                  status.state("following");
                  status.state("following");
                  a_moment();
                  status.state("holding");
                },
                "waiting"),
            "slave: ready in cell-1\nslave: following\nslave: holding\n");
}

TEST(StatusReporter, SaysEveryTenthOnce) {
  EXPECT_EQ(said_by([](StatusReporter& status) {
              for (const double fraction : {0.0, 0.05, 0.1, 0.19, 0.5, 1.0}) {
                status.progress(fraction, 20.0);
                a_moment();
              }
            }),
            "slave: 10 %, 18 s to go\nslave: 50 %, 10 s to go\n");
}

}  // namespace
}  // namespace telekerf
