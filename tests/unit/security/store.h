// SPDX-License-Identifier: Apache-2.0
// Keystores for tests, in folders of this process' own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/security/keystore.h"

namespace telekerf::security {

/// Made at construction, gone at its end.
class Store {
 public:
  explicit Store(const std::vector<std::string>& cells = {"cell-1"},
                 std::chrono::seconds life = std::chrono::hours(24) * 365) {
    static int count = 0;
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("telekerf-keys-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::remove_all(folder_);
    make_keystore(folder_, cells, life);
  }
  ~Store() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path role(const std::string& role, const std::string& cell = "cell-1") const {
    return role_files(folder_, cell, role).key.parent_path();
  }
  void copy(const std::filesystem::path& from, const std::filesystem::path& to) const {
    std::filesystem::copy(from, to, std::filesystem::copy_options::overwrite_existing);
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace telekerf::security
