// SPDX-License-Identifier: Apache-2.0
#include "common/control/drive_delay.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/control/drive_record.h"

namespace telekerf::control {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kQuarters = 4;
/// The triangle reaches this many steps into the past beyond the whole part of the delay.
constexpr Index kReach = 2;
constexpr double kEarliest = -1.0;  // periods: what is measured as less than zero is noise, and shows as such

/// How well a joint's motion is explained, `delay` in control periods.
struct Fit {
  double delay = 0.0;
  double left = 0.0;  // sum of squares that is not explained
  VectorXd parameters;
};

MatrixXd rows_of(const DriveRecord& record, std::span<const Index> steps, double delay) {
  const double whole = std::floor(delay);
  const double f = delay - whole;
  const auto n = static_cast<Index>(whole);
  const double weights[3] = {0.5 * (1.0 - f) * (1.0 - f), 0.5 + f * (1.0 - f), 0.5 * f * f};
  MatrixXd rows(static_cast<Index>(steps.size()), 3 + record.others.cols());
  for (Index r = 0; r < rows.rows(); ++r) {
    const Index k = steps[static_cast<std::size_t>(r)];
    rows.row(r).head(3) = weights[0] * record.asked.row(k - n) + weights[1] * record.asked.row(k - n - 1) +
                          weights[2] * record.asked.row(k - n - 2);
    rows.row(r).tail(record.others.cols()) = record.others.row(k);
  }
  return rows;
}

VectorXd measured_of(const DriveRecord& record, int joint, std::span<const Index> steps) {
  VectorXd out(static_cast<Index>(steps.size()));
  for (Index r = 0; r < out.size(); ++r) out[r] = record.measured(steps[static_cast<std::size_t>(r)], joint);
  return out;
}

Fit fit(const DriveRecord& record, int joint, std::span<const Index> steps, double delay) {
  MatrixXd rows = rows_of(record, steps, delay);
  const VectorXd measured = measured_of(record, joint, steps);
  // Columns differ by orders of magnitude.
  const VectorXd scale = rows.colwise().norm().transpose().cwiseMax(1e-12);
  rows *= scale.cwiseInverse().asDiagonal();
  MatrixXd gram = rows.transpose() * rows;
  gram.diagonal().array() += 1e-10;
  const VectorXd scaled = gram.ldlt().solve(rows.transpose() * measured);
  return {delay, (measured - rows * scaled).squaredNorm(), scaled.cwiseQuotient(scale)};
}

/// The delay at which `left(delay)` is least: on a grid, then by golden section.
template <typename Left>
double least(const Left& left) {
  constexpr double kGrid = 0.25;
  double best = kEarliest, least_left = left(kEarliest);
  for (double delay = kEarliest + kGrid; delay <= kLongestDriveDelay; delay += kGrid) {
    const double now = left(delay);
    if (now < least_left) {
      best = delay;
      least_left = now;
    }
  }
  double low = std::max(kEarliest, best - kGrid), high = std::min(kLongestDriveDelay, best + kGrid);
  const double ratio = 1.0 / std::numbers::phi;
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double left_a = left(a), left_b = left(b);
  while (high - low > 1e-3) {
    if (left_a < left_b) {
      high = b;
      b = a;
      left_b = left_a;
      a = high - ratio * (high - low);
      left_a = left(a);
    } else {
      low = a;
      a = b;
      left_a = left_b;
      b = low + ratio * (high - low);
      left_b = left(b);
    }
  }
  return 0.5 * (low + high);
}

double delay_of(const DriveRecord& record, int joint, std::span<const Index> steps) {
  return least([&](double delay) { return fit(record, joint, steps, delay).left; });
}

/// Sum of squares about the mean.
double variation_of(const DriveRecord& record, int joint, std::span<const Index> steps) {
  const VectorXd measured = measured_of(record, joint, steps);
  return std::max((measured.array() - measured.mean()).square().sum(), 1e-12);
}

double common_delay(const DriveRecord& record) {
  return least([&](double delay) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i)
      sum += fit(record, i, record.steps, delay).left / variation_of(record, i, record.steps);
    return sum;
  });
}

/// Steps that a hiccup of a clock has spoilt would count by the square of what they are off.
void leave_out_hiccups(DriveRecord& record, double delay) {
  constexpr double kTooFar = 5.0;  // times the typical residual
  std::vector<bool> bad(record.steps.size(), false);
  for (int i = 0; i < 3; ++i) {
    const VectorXd left =
        (measured_of(record, i, record.steps) -
         rows_of(record, record.steps, delay) * fit(record, i, record.steps, delay).parameters)
            .cwiseAbs();
    std::vector<double> sorted(left.begin(), left.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (Index r = 0; r < left.size(); ++r)
      if (left[r] > kTooFar * 1.48 * *middle) bad[static_cast<std::size_t>(r)] = true;
  }
  std::size_t kept = 0;
  for (std::size_t r = 0; r < record.steps.size(); ++r)
    if (!bad[r]) record.steps[kept++] = record.steps[r];
  record.steps.resize(kept);
}

}  // namespace

tl::expected<DriveDelay, std::string> estimate_drive_delay(std::span<const DriveSample> samples,
                                                           const robot::Friction& friction, double period_s,
                                                           double highest_hz) {
  constexpr std::size_t kFewest = 400;
  constexpr double kExplained = 0.98;    // below that dry friction makes a delay of its own
  constexpr double kMaxDeviation = 0.2;  // control periods
  DriveDelay out;
  const auto misses = std::count_if(samples.begin(), samples.end(), [](const auto& s) { return !s.valid; });
  out.missed = static_cast<double>(misses) / static_cast<double>(std::max<std::size_t>(samples.size(), 1));
  if (samples.size() < kFewest)
    return tl::unexpected(fmt::format("only {} steps were recorded", samples.size()));
  DriveRecord record =
      drive_record(samples, friction, period_s, highest_hz, static_cast<Index>(kLongestDriveDelay) + kReach);
  if (record.steps.size() >= kFewest) leave_out_hiccups(record, common_delay(record));
  if (record.steps.size() < kFewest) {
    return tl::unexpected(fmt::format(
        "{:.1f} % of the steps had no new reading, and too few are left between them", 100.0 * out.missed));
  }
  out.steps = record.steps.size();
  const double delay = common_delay(record);
  std::vector<double> parts;
  for (int i = 0; i < 3; ++i) {
    DriveDelay::Joint& joint = out.joints[static_cast<std::size_t>(i)];
    const Fit best = fit(record, i, record.steps, delay_of(record, i, record.steps));
    joint = {best.delay * period_s, best.parameters[i],
             1.0 - best.left / variation_of(record, i, record.steps)};
    const std::size_t quarter = record.steps.size() / kQuarters;
    for (std::size_t part = 0; part < kQuarters; ++part)
      parts.push_back(delay_of(record, i, std::span(record.steps).subspan(part * quarter, quarter)));
  }
  const VectorXd all = Eigen::Map<const VectorXd>(parts.data(), static_cast<Index>(parts.size()));
  out.spread_s = (all.maxCoeff() - all.minCoeff()) * period_s;
  out.deviation_s =
      std::sqrt((all.array() - all.mean()).square().sum() / static_cast<double>(all.size() - 1)) * period_s;
  for (int i = 0; i < 3; ++i) {
    const double explained = std::max(out.joints[static_cast<std::size_t>(i)].explained, 0.0);
    if (!(explained >= kExplained)) {
      return tl::unexpected(
          fmt::format("joint {} does not move as its force says: {:.0f} % of its acceleration is explained, "
                      "{:.0f} % are needed",
                      i + 1, 100.0 * explained, 100.0 * kExplained));
    }
  }
  if (delay > kLongestDriveDelay - 0.1) {
    return tl::unexpected(
        fmt::format("the readings are older than {:g} control periods", kLongestDriveDelay));
  }
  if (out.deviation_s > kMaxDeviation * period_s) {
    return tl::unexpected(
        fmt::format("the delay is not the same in all joints and at all times: from {:.2f} to {:.2f} ms",
                    1e3 * period_s * all.minCoeff(), 1e3 * period_s * all.maxCoeff()));
  }
  out.delay_s = std::max(delay, 0.0) * period_s;
  return out;
}

}  // namespace telekerf::control
