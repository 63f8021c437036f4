// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_rivals.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

#include "slave/vision/imaging/focus_law.h"

namespace telekerf::experiments {
namespace {

using namespace imaging;

constexpr double kReach_dof = 12.0;
constexpr int kPrintedPictures = 60;

struct Interval {
  double low_m, high_m;
};

Interval reach(const FocusRange& range) {
  const double reach_m = kReach_dof * range.depth_of_field_m;
  return {std::max(range.lowest_m, range.start_m - reach_m),
          std::min(range.highest_m, range.start_m + reach_m)};
}

double sharpness_at(VirtualUnit& unit, double position_m) {
  return normalised_variance(grey_sums(unit.look(position_m)));
}

/// Every rival claims that it has found the focus.
FocusOutcome left_at(VirtualUnit& unit, double position_m, int pictures) {
  unit.control().approach(kFocus, position_m);
  unit.settle();
  return {true, FocusVerdict::kFound, pictures, unit.defocus_dof()};
}

}  // namespace

FocusOutcome by_printed_law(VirtualUnit& unit, const FocusRange& range) {
  const double frame_s = unit.frame_period_s();
  const double dof_m = range.depth_of_field_m;
  // One depth of field a picture, a window of half of one; alpha for the gradients that pictures of 8 bits
  // have.
  const double mu_0 = dof_m / frame_s;
  PrintedFocusLaw law({.mu_0_m_per_s = mu_0, .alpha = 1.0 * dof_m, .window_m = 0.5 * dof_m});
  for (int i = 0; i < kPrintedPictures; ++i) {
    const cv::Mat picture = unit.next_frame();
    const double velocity = law.step(unit.measured_m().focus_m, normalised_variance(grey_sums(picture)));
    // Where nothing moves it does not start: the first pictures are taken in an excitation upwards.
    unit.control().drive(kFocus, i < 2 ? mu_0 : velocity);
  }
  unit.control().drive(kFocus, 0.0);
  unit.run(0.2);
  return {true, FocusVerdict::kFound, kPrintedPictures, unit.defocus_dof()};
}

FocusOutcome by_golden_section(VirtualUnit& unit, const FocusRange& range) {
  constexpr double kGolden = 0.381966;
  auto [a, b] = reach(range);
  double x1 = a + kGolden * (b - a);
  double x2 = b - kGolden * (b - a);
  double f1 = sharpness_at(unit, x1);
  double f2 = sharpness_at(unit, x2);
  int pictures = 2;
  for (; b - a > 0.3 * range.depth_of_field_m; ++pictures) {
    if (f1 > f2) {
      b = x2;
      x2 = x1;
      f2 = f1;
      x1 = a + kGolden * (b - a);
      f1 = sharpness_at(unit, x1);
    } else {
      a = x1;
      x1 = x2;
      f1 = f2;
      x2 = b - kGolden * (b - a);
      f2 = sharpness_at(unit, x2);
    }
  }
  return left_at(unit, 0.5 * (a + b), pictures);
}

FocusOutcome by_brent(VirtualUnit& unit, const FocusRange& range) {
  // Brent (1973), localmin, on the negative sharpness.
  constexpr double kGolden = 0.381966;
  constexpr int kMostPictures = 40;
  auto [a, b] = reach(range);
  const double tolerance = 0.05 * range.depth_of_field_m;
  double x = a + kGolden * (b - a);
  double w = x;
  double v = x;
  double fx = -sharpness_at(unit, x);
  double fw = fx;
  double fv = fx;
  double step = 0.0;
  double before = 0.0;
  int pictures = 1;
  for (; pictures < kMostPictures; ++pictures) {
    const double middle = 0.5 * (a + b);
    if (std::abs(x - middle) <= 2.0 * tolerance - 0.5 * (b - a)) break;
    bool golden = true;
    if (std::abs(before) > tolerance) {
      const double r = (x - w) * (fx - fv);
      double q = (x - v) * (fx - fw);
      double p = (x - v) * q - (x - w) * r;
      q = 2.0 * (q - r);
      if (q > 0.0) p = -p;
      q = std::abs(q);
      const double last = std::exchange(before, step);
      if (std::abs(p) < std::abs(0.5 * q * last) && p > q * (a - x) && p < q * (b - x)) {
        step = p / q;
        const double u = x + step;
        if (u - a < 2.0 * tolerance || b - u < 2.0 * tolerance) step = std::copysign(tolerance, middle - x);
        golden = false;
      }
    }
    if (golden) {
      before = (x < middle ? b : a) - x;
      step = kGolden * before;
    }
    const double u = x + (std::abs(step) >= tolerance ? step : std::copysign(tolerance, step));
    const double fu = -sharpness_at(unit, u);
    if (fu <= fx) {
      (u < x ? b : a) = x;
      v = std::exchange(w, std::exchange(x, u));
      fv = std::exchange(fw, std::exchange(fx, fu));
    } else {
      (u < x ? a : b) = u;
      if (fu <= fw || w == x) {
        v = std::exchange(w, u);
        fv = std::exchange(fw, fu);
      } else if (fu <= fv || v == x || v == w) {
        v = u;
        fv = fu;
      }
    }
  }
  return left_at(unit, x, pictures);
}

FocusOutcome by_largest_jpeg(VirtualUnit& unit, const FocusRange& range) {
  const auto [low_m, high_m] = reach(range);
  unit.control().approach(kFocus, low_m);
  unit.settle();
  const double frame_s = unit.frame_period_s();
  unit.control().drive(kFocus, 0.5 * range.depth_of_field_m / frame_s);
  double best_m = low_m;
  std::size_t largest = 0;
  int pictures = 0;
  while (unit.measured_m().focus_m < high_m - 1e-4 && pictures < 80) {
    const cv::Mat picture = unit.next_frame();
    ++pictures;
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});
    if (jpeg.size() <= largest) continue;
    largest = jpeg.size();
    best_m = unit.measured_m().focus_m;
  }
  return left_at(unit, best_m, pictures);
}

}  // namespace telekerf::experiments
