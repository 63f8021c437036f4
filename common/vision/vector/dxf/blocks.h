// SPDX-License-Identifier: Apache-2.0
// Where a DXF file keeps what it draws: sections of entities, and the blocks that an INSERT places.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// Entities as they stand in the file, read each time they are drawn.
struct DxfPart {
  std::string_view entities;
  std::size_t line = 0;  ///< of the file, where they begin
};

struct DxfBlock {
  DxfPart part;
  Vec2 base = Vec2::Zero();  ///< what lies where the block is inserted
  bool elsewhere = false;    ///< an external reference
};

struct DxfLayer {
  std::string why_hidden;  ///< empty: it is shown and plotted
  bool frozen = false;     ///< blocks inserted on it are hidden too
  int colour = 7;
  bool dashed = false;  ///< its line type has gaps
};

struct DxfContents {
  double metres = 1e-3;        ///< a unit, $INSUNITS
  std::string size_from;       ///< what says so
  std::vector<DxfPart> drawn;  ///< sections of entities
  std::map<std::string, DxfBlock> blocks;
  std::map<std::string, DxfLayer> layers;  ///< by name in capitals
};

/// A layer's name, which is the same in capitals.
std::string in_capitals(std::string_view name);
/// A line type (group 6) with gaps; that of layer or block is looked up there.
bool is_dashed(std::string_view line_type);

/// The first reading of a file, which `text` must outlive; `unit_m`: whatever the file says. The error is one
/// sentence.
tl::expected<DxfContents, std::string> contents_of(std::string_view text,
                                                   std::optional<double> unit_m = std::nullopt);

/// How often and where a block is drawn, in units of the drawing.
struct DxfInsert {
  std::string_view block;
  Vec2 at = Vec2::Zero();
  Vec2 scale = Vec2::Ones();
  double angle_deg = 0.0;
  int columns = 1;
  int rows = 1;
  Vec2 spacing = Vec2::Zero();  ///< from column to column, and from row to row
};

/// The block of an INSERT; the error says why it cannot be drawn.
tl::expected<DxfBlock, std::string> block_of(const DxfInsert& insert, const DxfContents& contents);

/// From a block's coordinates to those around the drawing, for one copy; `here` is where the INSERT stands.
Eigen::Affine2d place_of(const DxfInsert& insert, const DxfBlock& block, int row, int column,
                         Eigen::Affine2d here);

}  // namespace telekerf::vision
