// SPDX-License-Identifier: Apache-2.0
// What is cut so far, kept in a file over a restart of the console while master and slave go on.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/periodic.h"
#include "common/runtime/vectors.h"
#include "master/console/depth_plan.h"

namespace telekerf::master {

/// Of one piece of work: a contour, and the slave that cuts it.
struct CutSoFar {
  std::uint32_t contour_id = 0;
  std::uint32_t slave_epoch = 0;  ///< of another one nobody knows what lies under it
  std::vector<Vec2> places_m;     ///< as MarkTrail has them
  std::vector<double> lit_s;      ///< as DepthTrail has them
  DepthWish wish;
};
std::string text_of(const CutSoFar& cut);
/// None: it is nothing of this kind, or damaged.
std::optional<CutSoFar> parse_cut(std::string_view bytes);

/// Written by a thread of its own: nobody who drives waits for a disk.
class CutMemory {
 public:
  /// `path`: empty: nothing is kept. `complain` hears, in that thread and once, that it cannot be written.
  CutMemory(std::string path, std::function<void(const std::string&)> complain);
  /// Writes what was told last.
  ~CutMemory();
  CutMemory(const CutMemory&) = delete;
  CutMemory& operator=(const CutMemory&) = delete;

  /// Of the process before this one; none: there is nothing that can be read.
  std::optional<CutSoFar> found() const;
  void keep(const CutSoFar& cut);

 private:
  void write();

  std::string path_;
  std::function<void(const std::string&)> complain_;
  bool complained_ = false;
  std::mutex mutex_;
  std::optional<std::string> newest_;  ///< not yet written
  std::optional<Periodic> writing_;    ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf::master
