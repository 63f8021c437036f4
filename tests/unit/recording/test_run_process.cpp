// SPDX-License-Identifier: Apache-2.0
// Whether a recording's process still writes it: a service that is shown nothing but processes does not know
// the boot.
#include "common/recording/run_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/recording/h5.h"

namespace telekerf {
namespace {

class WritingProcess : public testing::Test {
 protected:
  WritingProcess() { write_process(file_.get()); }
  ~WritingProcess() override { std::filesystem::remove(path_); }

  void replace(const char* name, const std::string& text) {
    h5::check(H5Adelete(file_.get(), name), name);
    h5::set_text(file_.get(), name, text);
  }

  std::string path_ =
      (std::filesystem::temp_directory_path() / ("telekerf-process-" + std::to_string(::getpid()))).string();
  h5::Id file_{H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "no file"};
};

TEST_F(WritingProcess, IsSeenWhileItRunsWhetherItKnowsTheBootOrNot) {
  EXPECT_EQ(writing_process(file_.get()), ::getpid());
  replace("boot", "");
  EXPECT_EQ(writing_process(file_.get()), ::getpid());
}

TEST_F(WritingProcess, OfAnotherBootOrAnotherStartIsGone) {
  replace("boot", "of yesterday");
  EXPECT_EQ(writing_process(file_.get()), std::nullopt);
  replace("boot", "");
  replace("process_start", "1");
  EXPECT_EQ(writing_process(file_.get()), std::nullopt);
}

}  // namespace
}  // namespace telekerf
