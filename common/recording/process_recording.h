// SPDX-License-Identifier: Apache-2.0
// A process' recording: where it goes, what is said while it goes on, and how it ends.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/recording/record_flags.h"
#include "common/recording/recording.h"
#include "common/runtime/status_reporter.h"

namespace telekerf {

class ProcessRecording {
 public:
  /// Makes the file, and says where it is, unless the user has. `status`: what it says from now on is
  /// recorded. With `off` nothing is done. Throws StartupError if the folder that the user named cannot be
  /// written to; if none was named, that is said and the run goes on.
  ProcessRecording(const RecordFlags& flags, RunIdentity identity, const std::vector<Recording::Part>& parts,
                   StatusReporter& status);
  ~ProcessRecording();
  ProcessRecording(const ProcessRecording&) = delete;
  ProcessRecording& operator=(const ProcessRecording&) = delete;

  /// Null: nothing is recorded. The parts' rings have one producer each.
  RowRing* ring(std::size_t part) noexcept { return recording_ ? &recording_->ring(part) : nullptr; }
  /// The loop: a row of a part; wait-free.
  template <typename Row>
  void push(std::size_t part, std::span<const Column<Row>> columns, const Row& row) noexcept {
    if (recording_) recording_->ring(part).push(columns, row);
  }
  /// The loop: wait-free; a literal. The same again is said once.
  void fault(const char* what) noexcept {
    if (recording_ && what != fault_ && what != nullptr) recording_->fault(what);
    fault_ = what;
  }
  /// Beside the loop: contours that were prepared, unless they are known already.
  template <typename Contours>
  void contours(const Contours& prepared) {
    for (const auto& contour : prepared) {
      if (recording_ && contours_.insert(contour.id).second) recording_->add(recorded(contour));
    }
  }

  /// After the loop. True: there is a finished file.
  bool close(const RunEnd& end);
  /// After close(), when nothing worse is to be said: throws StartupError if the user has named a folder and the
  /// file in it is not a finished one.
  void refuse_unfinished() const;
  std::uint64_t dropped() const noexcept { return recording_ ? recording_->dropped() : 0; }
  /// Of the file; empty: nothing is recorded.
  std::filesystem::path file() const { return recording_ ? recording_->file() : std::filesystem::path(); }

 private:
  StatusReporter& status_;
  bool named_ = false;
  bool unfinished_ = false;
  std::set<std::uint32_t> contours_;
  const char* fault_ = nullptr;
  std::unique_ptr<Recording> recording_;
};

}  // namespace telekerf
