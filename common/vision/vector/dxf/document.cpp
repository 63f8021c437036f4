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
#include "common/vision/vector/text_encoding.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;

/// Lines may end in \r\n, in \r alone, or in \r\r\n where a file was converted twice.
std::string with_plain_line_ends(std::string text) {
  std::string out;
  out.reserve(text.size());
  const bool only_returns = text.find('\n') == std::string::npos;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\r') {
      out.push_back(text[i]);
      continue;
    }
    while (i + 1 < text.size() && text[i + 1] == '\r' && !only_returns) ++i;
    if (i + 1 < text.size() && text[i + 1] == '\n') ++i;
    out.push_back('\n');
  }
  return out;
}

class DxfReader {
 public:
  DxfReader(const DxfContents& contents, const VectorLimits& limits, const VectorRequest& request)
      : contents_(contents),
        max_groups_(limits.max_bytes / 4),
        out_(limits, request, Vec2::Constant(contents.metres)) {}

  tl::expected<VectorDrawing, std::string> drawing() {
    if (dashed_ > 0) out_.notes.push_back(fmt::format("{} dashed lines are cut whole (line type)", dashed_));
    return out_.drawing("DXF");
  }

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
        polyline->vertices.push_back({Vec2(entity->number[10], entity->number[20]), entity->number[42],
                                      entity->number[30], entity->flags});
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
  /// What a block takes over from its INSERT.
  struct Around {
    std::string layer;
    std::string colour = "7";
    std::string why_hidden;
  };

  const DxfLayer& layer_of(const std::string& name) const {
    static const DxfLayer kPlain;
    const auto found = contents_.layers.find(in_capitals(name));
    return found == contents_.layers.end() ? kPlain : found->second;
  }

  /// Sets the pen for what is drawn next.
  void choose_pen(const DxfEntity& e) {
    Pen& pen = out_.pen;
    pen.layer =
        e.layer.empty() || (e.layer == "0" && !around_.layer.empty()) ? around_.layer : std::string(e.layer);
    if (pen.layer.empty()) pen.layer.push_back('0');
    const DxfLayer& layer = layer_of(pen.layer);
    if (e.true_colour >= 0) {
      pen.colour = fmt::format("#{:06x}", e.true_colour);
    } else if (e.colour == 0) {
      pen.colour = around_.colour;
    } else {
      pen.colour = std::to_string(e.colour == 256 ? layer.colour : std::abs(e.colour));
    }
    out_.left_out_why = !around_.why_hidden.empty() ? around_.why_hidden
                        : e.invisible               ? "invisible"
                                                    : layer.why_hidden;
  }

  void draw(const DxfEntity& e, const Affine& outer) {
    if (out_.failed() || draws_nothing(e)) return;
    choose_pen(e);
    draw_shown(e, outer);
    out_.left_out_why.clear();
  }

  void draw_shown(const DxfEntity& e, const Affine& outer) {
    if (e.on_sheet) return out_.unsupported.add(e.kind + " on a sheet");
    if (e.tilted) return out_.unsupported.add("tilted " + e.kind);
    Affine here = outer;
    // These are given in coordinates of their own plane, the others in those of the drawing.
    for (const std::string_view planar : {"CIRCLE", "ARC", "LWPOLYLINE", "POLYLINE", "INSERT"}) {
      if (e.extruded_down && e.kind == planar) here.scale(Vec2(-1.0, 1.0));
    }
    if (e.kind == "INSERT") {
      // What is in a block on a layer that is only off may be on another one.
      const bool all_hidden = !around_.why_hidden.empty() || e.invisible || layer_of(out_.pen.layer).frozen;
      Around within{out_.pen.layer, out_.pen.colour, all_hidden ? out_.left_out_why : ""};
      std::swap(around_, within);
      insert(e.insert, here);
      std::swap(around_, within);
      return;
    }
    const std::size_t first = out_.count();
    draw_entity(e, here, out_);
    const bool by_layer = e.line_type.empty() || in_capitals(e.line_type) == "BYLAYER";
    const bool dashed = by_layer ? layer_of(out_.pen.layer).dashed : is_dashed(e.line_type);
    if (dashed && out_.left_out_why.empty() && out_.count() > first) ++dashed_;
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
  std::size_t dashed_ = 0;
  Around around_;
  DrawnLines out_;
};

}  // namespace

tl::expected<VectorDrawing, std::string> read_dxf(std::string_view bytes, const VectorLimits& limits,
                                                  const VectorRequest& request) {
  if (bytes.size() > limits.max_bytes) {
    return tl::unexpected(fmt::format("the DXF file is larger than {} MB", limits.max_bytes / 1000000));
  }
  if (bytes.substr(0, 18) == "AutoCAD Binary DXF") {
    return tl::unexpected<std::string>("binary DXF is not read; save the drawing as ASCII DXF");
  }
  const std::string text = with_plain_line_ends(utf8_of(bytes));
  const auto contents = contents_of(text, request.unit_m);
  if (!contents) return tl::unexpected(contents.error());
  DxfReader reader(*contents, limits, request);
  for (const DxfPart& section : contents->drawn) reader.draw(section, Affine::Identity());
  auto out = reader.drawing();
  if (out) out->size_from = contents->size_from;
  return out;
}

}  // namespace telekerf::vision
