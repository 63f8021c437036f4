// SPDX-License-Identifier: Apache-2.0
// A whole piece of work as one trajectory: approach, framing by the pilot beam, contours from the inside out,
// return.
#pragma once

#include <string>
#include <vector>

#include "slave/machining/timed_path.h"

namespace telekerf::machining {

struct JobSettings {
  TimedPathSettings plan;
  bool framing = true;            ///< run round the bounding box first, beam off
  double travel_m_per_s = 30e-3;  ///< between contours
  double travel_m_per_s2 = 1.0;
  double kerf_m = 0.0;         ///< closed contours are moved by half of it, holes inwards
  double settle_s = 0.3;       ///< at rest before each contour
  double reach_m = 0.1;        ///< framing stays within this distance of the workpiece's origin
  std::vector<double> select;  ///< whole numbers of the contours to cut; none: all
};

enum class JobPhase : std::uint8_t { kApproach, kFraming, kTravel, kCut, kReturn };

struct Job {
  Trajectory trajectory;
  std::vector<JobPhase> phases;           ///< one a tick
  std::vector<std::size_t> order;         ///< the contours' numbers as they are cut
  std::vector<TimedPath> plans;           ///< in that order
  std::vector<geometry::Polyline> lines;  ///< what each of them cuts: the contour, moved by half the kerf
  std::vector<std::string> warnings;      ///< what of the contours is not cut
  double period_s = 0.0;
  double cut_length_m = 0.0;
  double time_s() const noexcept { return period_s * static_cast<double>(trajectory.size()); }
};

/// Starts and ends at rest at `home_m`. What lies inside another contour is cut first; a hole is one whether
/// or not what is around it is cut too. The error is one sentence.
tl::expected<Job, std::string> make_job(const std::vector<geometry::Polyline>& contours,
                                        const JobSettings& settings, const Vec3& home_m = Vec3::Zero());

/// The same job for a tool that rests elsewhere: it is brought to the job's start first.
Job approached_from(const Vec3& tool_m, const Job& job, const JobSettings& settings);

}  // namespace telekerf::machining
