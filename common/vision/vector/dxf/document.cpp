// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/document.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>
#include <utility>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/dxf/blocks.h"
#include "common/vision/vector/dxf/entity.h"
#include "common/vision/vector/dxf/entity_lines.h"
#include "common/vision/vector/dxf/groups.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;

class DxfReader {
 public:
  DxfReader(const DxfContents& contents, const VectorLimits& limits)
      : contents_(contents),
        max_groups_(limits.max_bytes / 4),
        out_(limits, Vec2::Constant(contents.metres)) {}

  tl::expected<VectorDrawing, std::string> drawing() { return out_.drawing("DXF"); }

  /// Draws what a section or a block holds.
  void draw(const DxfPart& part, const Affine& here) {
    DxfGroups groups(part.entities, part.line);
    std::optional<DxfEntity> entity;    // being read
    std::optional<DxfEntity> polyline;  // an old POLYLINE that collects its VERTEX entities
    const auto flush = [&] {
      if (!entity) return;
      if (entity->kind == "POLYLINE") {
        polyline = std::exchange(entity, std::nullopt);
      } else if (entity->kind == "VERTEX" && polyline) {
        polyline->vertices.push_back({Vec2(entity->number[10], entity->number[20]), entity->number[42]});
      } else if (entity->kind == "SEQEND" && polyline) {
        draw(*polyline, here);
        polyline.reset();
      } else {
        draw(*entity, here);
      }
      entity.reset();
    };
    while (!out_.failed()) {
      const auto group = groups.next();
      if (!group) break;
      if (++groups_read_ > max_groups_) return out_.fail("blocks are inserted too often to be drawn");
      if (group->code == 0) {
        flush();
        entity.emplace();
        entity->kind = group->value.substr(0, 32);
      } else if (entity && !absorb(*entity, *group)) {
        return out_.fail(
            fmt::format("line {}: \"{:.40}\" is not a finite number", groups.line_number(), group->value));
      }
    }
    flush();
    if (polyline) draw(*polyline, here);
  }

 private:
  void draw(const DxfEntity& e, const Affine& outer) {
    if (out_.failed() || draws_nothing(e)) return;
    if (e.on_sheet) return out_.unsupported.add(e.kind + " on a sheet");
    if (e.tilted) return out_.unsupported.add("tilted " + e.kind);
    Affine here = outer;
    // These are given in coordinates of their own plane, the others in those of the drawing.
    for (const std::string_view planar : {"CIRCLE", "ARC", "LWPOLYLINE", "POLYLINE", "INSERT"}) {
      if (e.extruded_down && e.kind == planar) here.scale(Vec2(-1.0, 1.0));
    }
    if (e.kind == "INSERT") return insert(e.insert, here);
    draw_entity(e, here, out_);
  }

  void insert(const DxfInsert& insert, const Affine& here) {
    const auto block = block_of(insert, contents_);
    if (!block) return out_.fail(block.error());
    if (++depth_ > kMaxDepth)
      return out_.fail(fmt::format("block \"{:.40}\" is nested too deeply or in itself", insert.block));
    for (int row = 0; row < insert.rows && !out_.failed(); ++row) {
      for (int column = 0; column < insert.columns && !out_.failed(); ++column) {
        if (++groups_read_ > max_groups_) return out_.fail("blocks are inserted too often to be drawn");
        draw(block->part, place_of(insert, *block, row, column, here));
      }
    }
    --depth_;
  }

  static constexpr int kMaxDepth = 32;

  const DxfContents& contents_;
  std::size_t max_groups_;  ///< reading a file of that size without blocks takes about as long
  std::size_t groups_read_ = 0;
  int depth_ = 0;  ///< of blocks within blocks
  DrawnLines out_;
};

}  // namespace

tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.max_bytes) {
    return tl::unexpected(fmt::format("the DXF file is larger than {} MB", limits.max_bytes / 1000000));
  }
  if (text.substr(0, 18) == "AutoCAD Binary DXF") {
    return tl::unexpected<std::string>("binary DXF is not read; save the drawing as ASCII DXF");
  }
  const auto contents = contents_of(text);
  if (!contents) return tl::unexpected(contents.error());
  DxfReader reader(*contents, limits);
  for (const DxfPart& section : contents->drawn) reader.draw(section, Affine::Identity());
  return reader.drawing();
}

}  // namespace telekerf::vision
