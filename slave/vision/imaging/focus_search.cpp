// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/focus_search.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace telekerf::imaging {
namespace {

constexpr double kWidthOverBlur = 1.85;
constexpr int kMostExtensions = 4;  ///< pictures beyond the ends of the sweeps, in all
/// What lies farther from the highest picture is no parabola any more, and on one side of the peak only.
constexpr double kNear_dof = 1.05;

}  // namespace

int longest_span(std::array<bool, kTiles> tiles) {
  int longest = 0;
  std::vector<int> open;
  for (int first = 0; first < static_cast<int>(kTiles); ++first) {
    int left = kTileColumns;
    int right = -1;
    int top = kTileRows;
    int bottom = -1;
    if (std::exchange(tiles[static_cast<std::size_t>(first)], false)) open.push_back(first);
    while (!open.empty()) {
      const int x = open.back() % kTileColumns;
      const int y = open.back() / kTileColumns;
      open.pop_back();
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
      for (int v = std::max(0, y - 1); v <= std::min(kTileRows - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(kTileColumns - 1, x + 1); ++u) {
          const int beside = v * kTileColumns + u;
          if (std::exchange(tiles[static_cast<std::size_t>(beside)], false)) open.push_back(beside);
        }
      }
    }
    longest = std::max({longest, right - left + 1, bottom - top + 1});
  }
  return longest;
}

bool rises(double top, double bottom, double min_rise, double deviation) noexcept {
  return top > (1.0 + min_rise) * bottom + 6.0 * std::sqrt(2.0) * deviation;
}

double peak_width_dof(const Optics& optics, double magnification) noexcept {
  return kWidthOverBlur * optics.sharpest_px / optics.blur_px_per_dof(magnification);
}

FocusSearch FocusSearch::everywhere(const FocusSearchSettings& settings, const FocusRange& range,
                                    const Background& background) {
  FocusSearch search(settings, range, background);
  search.plan(Stage::kRest, range.start_m, 0.0, 2);
  return search;
}

FocusSearch FocusSearch::nearby(const FocusSearchSettings& settings, const FocusRange& range,
                                const Background& background) {
  FocusSearch search(settings, range, background);
  search.result_.noise_variance = background.noise_variance;
  const double step_m = settings.near_dof * range.depth_of_field_m;
  search.plan(Stage::kFine, range.start_m - 0.5 * (settings.near_pictures - 1) * step_m, step_m,
              settings.near_pictures);
  return search;
}

std::optional<double> FocusSearch::next_m() const noexcept {
  return stage_ == Stage::kDone ? std::nullopt : std::optional(plan_.back());
}

void FocusSearch::plan(Stage stage, double first_m, double step_m, int count) {
  stage_ = stage;
  step_m_ = step_m;
  looks_.clear();
  plan_.clear();
  for (int i = count; i-- > 0;) {
    const double at_m = first_m + i * step_m;
    if (at_m >= range_.lowest_m && at_m <= range_.highest_m) plan_.push_back(at_m);
  }
  if (plan_.empty()) finish(FocusVerdict::kOutOfRange, range_.start_m);
}

void FocusSearch::finish(FocusVerdict verdict, double position_m) {
  stage_ = Stage::kDone;
  plan_.clear();
  result_.verdict = verdict;
  result_.position_m = position_m;
}

void FocusSearch::seen(const cv::Mat& region, double position_m) {
  if (stage_ == Stage::kDone) return;
  ++result_.pictures;
  plan_.pop_back();
  const bool fine = stage_ == Stage::kFine || stage_ == Stage::kConfirm;
  Look look{position_m, sharpness_of(region, background_, fine)};
  looks_.insert(std::upper_bound(looks_.begin(), looks_.end(), position_m,
                                 [](double at, const Look& other) { return at < other.position_m; }),
                look);
  if (plan_.empty()) {
    switch (stage_) {
      case Stage::kRest:
        judge_rest(region);
        break;
      case Stage::kCoarse:
        judge_coarse();
        break;
      case Stage::kFine:
        judge_fine();
        break;
      case Stage::kConfirm:
        judge_second_look(region);
        break;
      case Stage::kDone:
        break;
    }
  }
  previous_ = region.clone();
}

void FocusSearch::judge_rest(const cv::Mat& region) {
  const RestPair pair = compare_at_rest(previous_, region);
  result_.noise_variance = background_.noise_variance = pair.noise_variance;
  if (pair.moved()) return finish(FocusVerdict::kMoving, range_.start_m);
  const double dof = range_.depth_of_field_m;
  const int half = static_cast<int>(settings_.reach_dof / settings_.coarse_dof + 1e-9);
  plan(Stage::kCoarse, range_.start_m - half * settings_.coarse_dof * dof, settings_.coarse_dof * dof,
       2 * half + 1);
}

bool FocusSearch::extend(std::size_t best, double step_m) {
  const double beyond_m = best == 0 ? looks_.front().position_m - step_m : looks_.back().position_m + step_m;
  if (extensions_ >= kMostExtensions || beyond_m < range_.lowest_m || beyond_m > range_.highest_m)
    return false;
  ++extensions_;
  plan_.push_back(beyond_m);
  return true;
}

void FocusSearch::remember_elsewhere() {
  std::vector<double> values(looks_.size());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    std::transform(looks_.begin(), looks_.end(), values.begin(),
                   [&](const Look& look) { return look.sharpness.tiles[tile]; });
    std::nth_element(values.begin(), middle, values.end());
    elsewhere_[tile] = std::max(0.0, *middle);
  }
  swept_ = true;
}

bool FocusSearch::is_supported(const Sharpness& here) const {
  // The deviation of the whole is that of many tiles together.
  const double deviation = std::sqrt(static_cast<double>(kTiles)) * here.variance_deviation;
  std::array<bool, kTiles> sharper{};
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    sharper[tile] = here.tiles[tile] > (1.0 + settings_.min_rise) * elsewhere_[tile] + 3.0 * deviation;
  }
  const double share = static_cast<double>(std::count(sharper.begin(), sharper.end(), true)) / kTiles;
  return share >= settings_.min_support ||
         (share >= settings_.min_line_support && longest_span(sharper) >= settings_.min_span);
}

void FocusSearch::judge_coarse() {
  const auto by_variance = [](const Look& a, const Look& b) {
    return a.sharpness.variance < b.sharpness.variance;
  };
  const auto top = std::max_element(looks_.begin(), looks_.end(), by_variance);
  const auto best = static_cast<std::size_t>(top - looks_.begin());
  const Sharpness& sharpest = top->sharpness;
  const double lowest = std::min_element(looks_.begin(), looks_.end(), by_variance)->sharpness.variance;
  if (!rises(sharpest.variance, lowest, settings_.min_rise, sharpest.variance_deviation))
    return finish(FocusVerdict::kBlank, range_.start_m);
  if (best == 0 || best + 1 == looks_.size()) {
    if (!extend(best, step_m_)) finish(FocusVerdict::kOutOfRange, top->position_m);
    return;
  }
  remember_elsewhere();
  if (!is_supported(sharpest)) return finish(FocusVerdict::kSpecks, top->position_m);
  // A parabola through the logarithms of three.
  const auto log_at = [&](std::size_t i) {
    return std::log(std::max(looks_[i].sharpness.variance, sharpest.variance_deviation + 1e-12));
  };
  const double left = log_at(best - 1);
  const double right = log_at(best + 1);
  const double curvature = left - 2.0 * log_at(best) + right;
  const double shift = curvature < 0.0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0.0;
  const double centre_m = top->position_m + shift * step_m_;
  const double fine_m = settings_.fine_dof * range_.depth_of_field_m;
  plan(Stage::kFine, centre_m - 0.5 * (settings_.fine_pictures - 1) * fine_m, fine_m,
       settings_.fine_pictures);
}

std::optional<FocusSearch::Peak> FocusSearch::fitted() const {
  const auto top = std::max_element(looks_.begin(), looks_.end(), [](const Look& a, const Look& b) {
    return a.sharpness.tenengrad < b.sharpness.tenengrad;
  });
  std::vector<const Look*> used;
  for (const Look& look : looks_) {
    if (std::abs(look.position_m - top->position_m) <= kNear_dof * range_.depth_of_field_m &&
        look.sharpness.tenengrad > 0.0)
      used.push_back(&look);
  }
  const double unit_m = range_.depth_of_field_m;
  Eigen::MatrixXd terms(used.size(), 3);
  Eigen::VectorXd logs(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double z = (used[i]->position_m - top->position_m) / unit_m;
    // What is higher is better known, and nearer to a parabola.
    const double weight = used[i]->sharpness.tenengrad / top->sharpness.tenengrad;
    terms.row(row) << weight, weight * z, weight * z * z;
    logs[row] = weight * std::log(used[i]->sharpness.tenengrad);
  }
  const Eigen::Vector3d c = terms.colPivHouseholderQr().solve(logs);
  if (!(c[2] < 0.0)) return std::nullopt;  // as of fewer than three
  const double z = -0.5 * c[1] / c[2];
  return Peak{top->position_m + unit_m * z, c[0] + 0.5 * c[1] * z, unit_m * std::sqrt(-0.5 / c[2])};
}

void FocusSearch::judge_fine() {
  const auto by_slope = [](const Look& a, const Look& b) {
    return a.sharpness.tenengrad < b.sharpness.tenengrad;
  };
  const auto top = std::max_element(looks_.begin(), looks_.end(), by_slope);
  const auto best = static_cast<std::size_t>(top - looks_.begin());
  const double lowest = std::min_element(looks_.begin(), looks_.end(), by_slope)->sharpness.tenengrad;
  if (!rises(top->sharpness.tenengrad, lowest, settings_.min_rise, top->sharpness.tenengrad_deviation))
    return finish(FocusVerdict::kBlank, top->position_m);
  if (best == 0 || best + 1 == looks_.size()) {
    if (!extend(best, step_m_)) finish(FocusVerdict::kNoPeak, top->position_m);
    return;
  }
  const auto peak = fitted();
  const double dof = range_.depth_of_field_m;
  const double expected_m = range_.peak_width_dof * dof;
  if (!peak || std::abs(peak->position_m - top->position_m) > step_m_ ||
      peak->width_m < settings_.min_width * expected_m || peak->width_m > settings_.max_width * expected_m)
    return finish(FocusVerdict::kNoPeak, top->position_m);
  peak_ = *peak;
  result_.width_dof = peak_.width_m / dof;
  plan(Stage::kConfirm, peak_.position_m, 0.0, 2);
}

void FocusSearch::judge_second_look(const cv::Mat& region) {
  if (compare_at_rest(previous_, region).moved()) return finish(FocusVerdict::kMoving, peak_.position_m);
  const Sharpness& a = looks_.front().sharpness;
  // In the very focus specks are smallest: on fewer tiles than in the coarse sweep.
  if (swept_ && !is_supported(a)) return finish(FocusVerdict::kSpecks, peak_.position_m);
  const Sharpness& b = looks_.back().sharpness;
  result_.tenengrad = 0.5 * (a.tenengrad + b.tenengrad);
  result_.variance = 0.5 * (a.variance + b.variance);
  const double expected = std::exp(peak_.log_height);
  const double deviation = a.tenengrad_deviation;
  const bool repeated =
      std::min(a.tenengrad, b.tenengrad) >= (1.0 - settings_.max_fall) * expected - 3.0 * deviation;
  finish(repeated ? FocusVerdict::kFound : FocusVerdict::kNotRepeated, peak_.position_m);
}

}  // namespace telekerf::imaging
