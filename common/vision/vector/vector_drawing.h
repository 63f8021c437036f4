// SPDX-License-Identifier: Apache-2.0
// A drawing that says its own size: what the readers of SVG and DXF are asked for, and what they give.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/runtime/enum_table.h"
#include "common/vision/vector/unsupported_elements.h"

namespace telekerf::vision {

/// Bounds that keep a hostile file from filling memory or time.
struct VectorLimits {
  double chord_error_m = 0.1e-6;  ///< largest distance of a curve from its polyline
  std::size_t max_points = 6'000'000;
  std::size_t max_bytes = 64'000'000;
};

/// What a unit of a file is taken for.
enum class LengthUnit { kFile, kMillimetre, kCentimetre, kMetre, kInch, kFoot, kPoint, kMicrometre };
inline constexpr EnumRow<LengthUnit> kLengthUnitRows[] = {
    {"file", LengthUnit::kFile, "what the file says"},
    {"mm", LengthUnit::kMillimetre, "a millimetre"},
    {"cm", LengthUnit::kCentimetre, "a centimetre"},
    {"m", LengthUnit::kMetre, "a metre"},
    {"inch", LengthUnit::kInch, "an inch"},
    {"foot", LengthUnit::kFoot, "a foot"},
    {"pt", LengthUnit::kPoint, "1/72 inch"},
    {"um", LengthUnit::kMicrometre, "a micrometre"},
};
inline constexpr EnumTable<LengthUnit> kLengthUnits(kLengthUnitRows);
/// Metres; nothing: what the file says.
std::optional<double> metres_of(LengthUnit unit);

/// How a drawing is to be understood where the file leaves it open, and what of it is wanted.
struct VectorRequest {
  double join_m = 10e-6;  ///< ends that are as near as this are one point
  std::optional<double> dpi =
      std::nullopt;  ///< pixels an inch of SVG; else 96, or what the program used that wrote it
  std::optional<double> unit_m = std::nullopt;  ///< a unit of the file, whatever it says
  std::vector<std::string> layers = {};         ///< these alone; none: all that are shown
  std::vector<std::string> colours = {};  ///< these alone, as the file names them or as #rrggbb; none: all
};

/// What a contour was drawn with.
struct Pen {
  std::string layer;   ///< empty: none; one within another of an SVG file: "outer/inner"
  std::string colour;  ///< #rrggbb, the number of a DXF colour, or empty
};

struct LeftOut {
  geometry::Polyline line;
  Pen pen;
  std::string why;
};

/// Contours in metres, x to the right, y upwards, in the file's own frame; ends that meet are joined, and of
/// lines that lie on each other there is one.
struct VectorDrawing {
  std::vector<geometry::Polyline> contours;
  std::vector<Pen> pens;          ///< one a contour
  std::vector<LeftOut> left_out;  ///< drawn in the file, and not to be cut
  std::size_t joined = 0;         ///< ends that became one with another
  double page_width_m = 0.0;      ///< 0: the file does not say
  double page_height_m = 0.0;
  std::string size_from;           ///< what says how large it is
  std::vector<std::string> notes;  ///< sentences for people
  UnsupportedElements
      unsupported;  ///< text, images, dimensions: what has no line, or none that is understood
};

}  // namespace telekerf::vision
