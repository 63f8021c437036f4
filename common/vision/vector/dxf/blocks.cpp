// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/vision/vector/dxf/groups.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

/// $INSUNITS -> metres; unitless drawings are taken as millimetres.
std::optional<double> metres_of_unit(std::string_view text) {
  const auto unit = take_number(text);
  if (!unit) return std::nullopt;
  switch (static_cast<int>(std::clamp(*unit, -1.0, 100.0))) {
    case 0:
      return 1e-3;
    case 1:
      return 25.4e-3;
    case 2:
      return 0.3048;
    case 4:
      return 1e-3;
    case 5:
      return 1e-2;
    case 6:
      return 1.0;
    case 8:
      return 25.4e-9;
    case 9:
      return 25.4e-6;
    case 10:
      return 0.9144;
    case 12:
      return 1e-9;
    case 13:
      return 1e-6;
    case 14:
      return 0.1;
    default:
      return std::nullopt;
  }
}

/// Ends a part where the `rest` of the file begins.
void end(DxfPart& part, const DxfPart& rest) {
  part.entities.remove_suffix(std::min(part.entities.size(), rest.entities.size()));
}

/// The blocks of a section, group by group.
class Blocks {
 public:
  explicit Blocks(std::map<std::string_view, DxfBlock>& found) : found_(found) {}

  /// `rest`: the file from this group on.
  void take(const DxfGroup& group, const DxfPart& rest) {
    if (group.code != 0) {
      if (in_head_) take_head(group);
      return;
    }
    if (std::exchange(in_head_, group.value == "BLOCK")) block_.part = rest;
    if (in_head_) {
      block_ = {};
      name_ = {};
    }
    if (group.value == "ENDBLK") {
      end(block_.part, rest);
      found_.emplace(name_, block_);
    }
  }

 private:
  void take_head(const DxfGroup& group) {
    std::string_view digits = group.value;
    if (group.code == 2) name_ = group.value;
    if (group.code == 10) block_.base.x() = take_number(digits).value_or(NAN);
    if (group.code == 20) block_.base.y() = take_number(digits).value_or(NAN);
    if (group.code == 70) block_.elsewhere = (std::lround(take_number(digits).value_or(0.0)) & (4 | 8)) != 0;
  }

  std::map<std::string_view, DxfBlock>& found_;
  std::string_view name_;
  DxfBlock block_;
  bool in_head_ = false;  ///< between a BLOCK and its first entity
};

}  // namespace

tl::expected<DxfContents, std::string> contents_of(std::string_view text) {
  DxfGroups groups(text);
  DxfContents out;
  Blocks blocks(out.blocks);
  std::string_view section;
  bool any_section = false;
  std::string_view variable;
  DxfPart here{text, 0};  // from the group in hand
  for (; const auto group = groups.next(); here = {groups.rest(), groups.line_number()}) {
    const bool section_ends = group->value == "SECTION" || group->value == "ENDSEC" || group->value == "EOF";
    if (group->code == 0 && section_ends) {
      if (section == "ENTITIES") end(out.drawn.back(), here);
      section = {};
      any_section = true;
      if (group->value == "EOF") break;
    } else if (group->code == 2 && section.empty()) {
      section = group->value;
      if (section == "ENTITIES") out.drawn.push_back({groups.rest(), groups.line_number()});
    } else if (section == "BLOCKS") {
      blocks.take(*group, here);
    } else if (section == "HEADER") {
      if (group->code == 9) variable = group->value;
      if (variable != "$INSUNITS" || group->code != 70) continue;
      const auto metres = metres_of_unit(group->value);
      if (!metres)
        return tl::unexpected(fmt::format("$INSUNITS {:.20} is not a unit that is understood", group->value));
      out.metres = *metres;
    }
  }
  if (groups.damaged())
    return tl::unexpected(fmt::format("not a DXF file, or damaged, near line {}", groups.line_number()));
  if (!any_section && out.drawn.empty()) return tl::unexpected<std::string>("not a DXF file");
  return out;
}

tl::expected<DxfBlock, std::string> block_of(const DxfInsert& insert, const DxfContents& contents) {
  const auto found = contents.blocks.find(insert.block);
  if (found == contents.blocks.end())
    return tl::unexpected(
        fmt::format("INSERT of block \"{:.40}\", which the file does not define", insert.block));
  if (found->second.elsewhere)
    return tl::unexpected(
        fmt::format("block \"{:.40}\" is in another file; bind it into the drawing first", insert.block));
  return found->second;
}

Eigen::Affine2d place_of(const DxfInsert& insert, const DxfBlock& block, int row, int column,
                         Eigen::Affine2d here) {
  return here.translate(insert.at)
      .rotate(insert.angle_deg * M_PI / 180.0)
      .translate(insert.spacing.cwiseProduct(Vec2(column, row)))
      .scale(insert.scale)
      .translate(-block.base);
}

}  // namespace telekerf::vision
