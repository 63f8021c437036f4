// SPDX-License-Identifier: Apache-2.0
// The file in which a station keeps the emergency stops that are in force over a restart.
#pragma once

#include <string>

#include "common/protocol/stop_latch.h"

namespace telekerf {

class StopFile {
 public:
  /// `path`: empty: none is kept. Throws StartupError where it cannot be read or written, and where what
  /// stands in it is no stop: nobody would know then whether one is in force.
  explicit StopFile(std::string path);

  /// Of the last run; none in force where there is no file.
  const StopLatch& found() const noexcept { return found_; }
  /// Whole, or as it was before; whatever becomes of the process. No text: no file. Why not, for people;
  /// empty: it is kept.
  std::string keep(const std::string& text) const;
  /// What was kept last is on the disk, too, whatever becomes of the computer. May take long.
  void settle() const;
  const std::string& path() const noexcept { return path_; }

 private:
  std::string write(const std::string& text) const;

  std::string path_;
  StopLatch found_;
};

}  // namespace telekerf
