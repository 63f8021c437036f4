// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "common/vision/vector/dxf/groups.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

/// $INSUNITS -> metres; 0: the file does not say.
std::optional<double> metres_of_unit(std::string_view text) {
  constexpr std::array<double, 25> kUnits{0.0,
                                          25.4e-3,
                                          0.3048,
                                          1609.344,
                                          1e-3,
                                          1e-2,
                                          1.0,
                                          1e3,
                                          25.4e-9,
                                          25.4e-6,
                                          0.9144,
                                          1e-10,
                                          1e-9,
                                          1e-6,
                                          0.1,
                                          10.0,
                                          100.0,
                                          1e9,
                                          1.495978707e11,
                                          9.4607e15,
                                          3.0857e16,
                                          1200.0 / 3937.0,
                                          100.0 / 3937.0,
                                          3600.0 / 3937.0,
                                          1609.347};
  const auto unit = take_number(text);
  if (!unit || *unit < 0.0 || *unit >= static_cast<double>(kUnits.size())) return std::nullopt;
  return kUnits[static_cast<std::size_t>(*unit)];
}

/// Ends a part where the `rest` of the file begins.
void end(DxfPart& part, const DxfPart& rest) {
  part.entities.remove_suffix(std::min(part.entities.size(), rest.entities.size()));
}

/// The layers of the tables, group by group.
class Layers {
 public:
  explicit Layers(std::map<std::string, DxfLayer>& found) : found_(found) {}

  void take(const DxfGroup& group) {
    if (group.code == 0) {
      end();
      in_layer_ = group.value == "LAYER";
      return;
    }
    if (!in_layer_) return;
    std::string_view digits = group.value;
    if (group.code == 2) name_ = in_capitals(group.value);
    if (group.code == 70) flags_ = std::lround(std::clamp(take_number(digits).value_or(0.0), 0.0, 1e6));
    if (group.code == 62)
      colour_ = static_cast<int>(std::clamp(take_number(digits).value_or(7.0), -256.0, 256.0));
    if (group.code == 6) line_type_ = group.value;
    if (group.code == 290) plotted_ = take_number(digits).value_or(1.0) != 0.0;
  }

  void end() {
    if (!std::exchange(in_layer_, false) || name_.empty()) return;
    DxfLayer layer;
    layer.frozen = (flags_ & 1) != 0;
    layer.colour = std::abs(colour_);
    layer.dashed = is_dashed(line_type_);
    if (layer.frozen) {
      layer.why_hidden = "on the frozen layer " + name_;
    } else if (colour_ < 0) {
      layer.why_hidden = "on the layer " + name_ + ", which is off";
    } else if (!plotted_ || name_ == "DEFPOINTS") {
      layer.why_hidden = "on the layer " + name_ + ", which is not plotted";
    }
    found_[name_] = layer;
    name_.clear();
    flags_ = 0;
    colour_ = 7;
    plotted_ = true;
    line_type_ = {};
  }

 private:
  std::map<std::string, DxfLayer>& found_;
  bool in_layer_ = false;
  std::string name_;
  long flags_ = 0;
  int colour_ = 7;
  bool plotted_ = true;
  std::string_view line_type_;
};

/// The blocks of a section, group by group.
class Blocks {
 public:
  explicit Blocks(std::map<std::string, DxfBlock>& found) : found_(found) {}

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
      found_.emplace(in_capitals(name_), block_);
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

  std::map<std::string, DxfBlock>& found_;
  std::string_view name_;
  DxfBlock block_;
  bool in_head_ = false;  ///< between a BLOCK and its first entity
};

}  // namespace

std::string in_capitals(std::string_view name) {
  std::string out(name);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::toupper(c); });
  return out;
}

bool is_dashed(std::string_view line_type) {
  const std::string name = in_capitals(line_type);
  return !name.empty() && name != "CONTINUOUS" && name != "BYLAYER" && name != "BYBLOCK";
}

tl::expected<DxfContents, std::string> contents_of(std::string_view text, std::optional<double> unit_m) {
  DxfGroups groups(text);
  DxfContents out;
  Blocks blocks(out.blocks);
  Layers layers(out.layers);
  double unit = 0.0;
  bool imperial = false;
  bool metric = false;
  out.layers["DEFPOINTS"].why_hidden = "on the layer DEFPOINTS, which is not plotted";
  std::string_view section;
  bool any_section = false;
  bool unfinished = false;  // within a section
  std::string_view variable;
  DxfPart here{text, 0};  // from the group in hand
  for (; const auto group = groups.next(); here = {groups.rest(), groups.line_number()}) {
    const bool section_ends = group->value == "SECTION" || group->value == "ENDSEC" || group->value == "EOF";
    if (group->code == 0 && section_ends) {
      if (section == "ENTITIES") end(out.drawn.back(), here);
      if (section == "TABLES") layers.end();
      section = {};
      any_section = true;
      unfinished = group->value == "SECTION";
      if (group->value == "EOF") break;
    } else if (group->code == 2 && section.empty()) {
      section = group->value;
      if (section == "ENTITIES") out.drawn.push_back({groups.rest(), groups.line_number()});
    } else if (section == "BLOCKS") {
      blocks.take(*group, here);
    } else if (section == "TABLES") {
      layers.take(*group);
    } else if (section == "HEADER") {
      if (group->code == 9) variable = group->value;
      if (variable == "$MEASUREMENT" && group->code == 70) {
        std::string_view digits = group->value;
        const double system = take_number(digits).value_or(-1.0);
        imperial = system == 0.0;
        metric = system == 1.0;
      }
      if (variable != "$INSUNITS" || group->code != 70 || unit_m) continue;
      const auto metres = metres_of_unit(group->value);
      if (!metres)
        return tl::unexpected(fmt::format(
            "$INSUNITS {:.20} is not a unit that is understood; say what a unit is: --units mm|cm|m|inch",
            group->value));
      unit = *metres;
    }
  }
  if (groups.damaged())
    return tl::unexpected(fmt::format("not a DXF file, or damaged, near line {}", groups.line_number()));
  if (unfinished)
    return tl::unexpected(
        fmt::format("the DXF file ends at line {} in the middle of a section: it is not whole; copy it anew",
                    groups.line_number()));
  if (!any_section && out.drawn.empty()) return tl::unexpected<std::string>("not a DXF file");
  if (unit_m) {
    out.metres = *unit_m;
    out.size_from = fmt::format("a unit is {:g} mm, as asked for", 1e3 * *unit_m);
  } else if (unit > 0.0) {
    out.metres = unit;
    out.size_from = fmt::format("$INSUNITS: a unit is {:g} mm", 1e3 * unit);
  } else if (imperial) {
    out.metres = 25.4e-3;
    out.size_from = "no $INSUNITS, and $MEASUREMENT 0: a unit is an inch (--units mm if it is not so)";
  } else if (metric) {
    out.size_from = "no $INSUNITS, and $MEASUREMENT 1: a unit is a millimetre (--units cm if it is not so)";
  } else {
    out.size_from = "the file has no unit: millimetres are taken (--units inch if it is not so)";
  }
  return out;
}

tl::expected<DxfBlock, std::string> block_of(const DxfInsert& insert, const DxfContents& contents) {
  const auto found = contents.blocks.find(in_capitals(insert.block));
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
