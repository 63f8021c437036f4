// SPDX-License-Identifier: Apache-2.0
// Finds the focus: a coarse sweep over the normalised variance says about where, a fine one over Tenengrad
// and a parabola through its logarithm says where exactly, two pictures there confirm it. Every sweep goes
// upwards, so that play is always taken up on the same side. "No focus found" is a result, and has a reason.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/runtime/enum_table.h"
#include "slave/vision/imaging/optics.h"
#include "slave/vision/imaging/sharpness.h"

namespace telekerf::imaging {

enum class FocusVerdict : std::uint8_t {
  kFound,
  kBlank,
  kOutOfRange,
  kMoving,
  kSpecks,
  kNoPeak,
  kNotRepeated
};
inline constexpr EnumRow<FocusVerdict> kFocusVerdictRows[] = {
    {"found", FocusVerdict::kFound, "the focus was found"},
    {"blank", FocusVerdict::kBlank,
     "nothing stands out from the noise anywhere in the range: a blank object, or one far out of focus"},
    {"out of range", FocusVerdict::kOutOfRange,
     "the picture is sharpest at the end of the range, the focus lies beyond"},
    {"moving", FocusVerdict::kMoving, "the object moves between two pictures"},
    {"specks", FocusVerdict::kSpecks, "only single specks become sharp, as of dust"},
    {"no peak", FocusVerdict::kNoPeak, "no peak as the optics would make it"},
    {"not repeated", FocusVerdict::kNotRepeated, "a second look was not as sharp as the first"},
};
inline constexpr EnumTable<FocusVerdict> kFocusVerdicts(kFocusVerdictRows);

struct FocusSearchSettings {
  double reach_dof = 12.0;  ///< to either side of where it starts
  double coarse_dof = 2.0;  ///< step of the coarse sweep
  double fine_dof = 0.5;    ///< step of the fine one,
  int fine_pictures = 7;    ///< about the coarse peak
  double near_dof = 0.7;    ///< step when the ridge says where the focus is,
  int near_pictures = 5;
  double min_rise = 0.05;    ///< the peak above the farthest, as a share, beside 6 standard deviations
  double min_support = 0.3;  ///< share of the tiles that must become sharper
  /// Fewer are enough where they hang together over `min_span` tiles across or down, as those of a drawn line
  /// do and those of specks do not.
  double min_line_support = 0.2;
  int min_span = 7;
  double min_width = 0.5;  ///< of the peak, as a share of what the optics make of it
  double max_width = 4.0;  ///< coarse structures make it wider
  double max_fall =
      0.05;  ///< of the second look below the parabola, as a share, beside 3 standard deviations
};

/// Of the tiles that are set (row by row) and touch each other, corners included: how many rows or columns
/// they reach over at the most.
int longest_span(std::array<bool, kTiles> tiles);

/// Whether a sharpness stands out from the least one: by the share `min_rise` of that, and by six standard
/// deviations of the difference of the two, each of which noise gives `deviation`.
bool rises(double top, double bottom, double min_rise, double deviation) noexcept;

/// Where the search may go.
struct FocusRange {
  double start_m = 0.0;
  double lowest_m = 0.0;  ///< of the axis
  double highest_m = 0.0;
  double depth_of_field_m = 1e-3;
  double peak_width_dof = 1.2;  ///< standard deviation of Tenengrad's peak, as a Gaussian, by the optics
};

/// Standard deviation of Tenengrad's peak by these optics, depths of field: on textures between fine grain
/// and printed edges it is 1.6 to 2.2 times the defocus that blurs as much as is left in focus.
double peak_width_dof(const Optics& optics, double magnification) noexcept;

struct FocusResult {
  FocusVerdict verdict = FocusVerdict::kNoPeak;
  double position_m = 0.0;  ///< of the focus axis; where none was found: where it was sharpest
  double width_dof = 0.0;   ///< standard deviation of Tenengrad's peak, as a Gaussian
  double tenengrad = 0.0;   ///< of the second look
  double variance = 0.0;
  double noise_variance = 0.0;
  int pictures = 0;  ///< all that were taken
  bool found() const noexcept { return verdict == FocusVerdict::kFound; }
};

class FocusSearch {
 public:
  /// Over the whole reach about range.start_m. `background.noise_variance` is measured.
  static FocusSearch everywhere(const FocusSearchSettings& settings, const FocusRange& range,
                                const Background& background);
  /// About range.start_m, where the ridge expects it; the noise is known.
  static FocusSearch nearby(const FocusSearchSettings& settings, const FocusRange& range,
                            const Background& background);

  /// Where the next picture is to be taken, metres of the focus axis, to be approached from below; none:
  /// done.
  std::optional<double> next_m() const noexcept;
  /// The region of a picture taken at `position_m`, as measured.
  void seen(const cv::Mat& region, double position_m);

  /// When there is no next picture.
  const FocusResult& result() const noexcept { return result_; }

 private:
  enum class Stage : std::uint8_t { kRest, kCoarse, kFine, kConfirm, kDone };
  struct Look {
    double position_m;
    Sharpness sharpness;
  };
  struct Peak {
    double position_m, log_height, width_m;
  };

  FocusSearch(const FocusSearchSettings& settings, const FocusRange& range, const Background& background)
      : settings_(settings), range_(range), background_(background) {}

  void plan(Stage stage, double first_m, double step_m, int count);
  void finish(FocusVerdict verdict, double position_m);
  void judge_rest(const cv::Mat& region);
  void judge_coarse();
  void judge_fine();
  void judge_second_look(const cv::Mat& region);
  /// Goes on beyond the end of the sweep where the peak is. False: there is no more room.
  bool extend(std::size_t best, double step_m);
  /// How sharp each tile is at most places of the coarse sweep.
  void remember_elsewhere();
  /// Enough of the object becomes sharper here than elsewhere.
  bool is_supported(const Sharpness& here) const;
  std::optional<Peak> fitted() const;

  FocusSearchSettings settings_;
  FocusRange range_;
  Background background_;
  Stage stage_ = Stage::kRest;
  std::vector<double> plan_;  ///< what is still to be taken, the next one last
  std::vector<Look> looks_;   ///< of this sweep, by position
  cv::Mat previous_;          ///< region of the picture before
  std::array<double, kTiles> elsewhere_{};
  bool swept_ = false;
  Peak peak_{};
  double step_m_ = 0.0;
  int extensions_ = 0;
  FocusResult result_;
};

}  // namespace telekerf::imaging
