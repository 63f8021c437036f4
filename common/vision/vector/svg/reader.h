// SPDX-License-Identifier: Apache-2.0
// The elements of an SVG file, one within the other -> lines.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/svg/lengths.h"
#include "common/vision/vector/svg/page.h"
#include "common/vision/vector/svg/style.h"

namespace telekerf::vision {

class SvgReader {
 public:
  SvgReader(const tinyxml2::XMLElement& root, const SvgPage& page, const VectorLimits& limits,
            const VectorRequest& request);

  /// Draws all that the root holds.
  tl::expected<VectorDrawing, std::string> drawing();

 private:
  using Affine = Eigen::Affine2d;
  using Element = tinyxml2::XMLElement;
  /// What an element takes over from those around it.
  struct Inherited {
    Affine here;
    Look look;
    int depth = 0;
  };

  void find_names(const Element& e, int depth);
  void children(const Element& e, const Inherited& inherited);
  void element(const Element& e, const Inherited& around);
  /// The element itself, its own properties known; `here` of `self` is its own.
  void contents(std::string_view name, const Element& e, const Properties& own, const Inherited& self);
  void shape(std::string_view name, const Element& e, const Properties& own, const Inherited& self);
  void first_choice(const Element& e, const Inherited& self);
  void use(const Element& e, const Properties& own, const Inherited& self);
  void viewport(const Element& e, const Properties& own, const Inherited& self, const Vec2& size);
  bool draws_nothing(std::string_view name) const;
  /// False: it fails.
  bool transform(const Properties& own, Affine& here);
  void leave_out_background(std::size_t first, const Painted& painted);
  /// What was drawn since `first` is seen through the element's clip-path or mask alone.
  void clip(const Properties& own, const Inherited& self, std::size_t first);
  /// Leaves out what has been drawn since `first` and lies outside; what is cut through is refused.
  void clip_by(const std::vector<geometry::Polyline>& hole, std::size_t first, const std::string& its,
               const std::string& name);
  std::vector<geometry::Polyline> hole_of(const Element& e, const Inherited& self, bool mask);

  const Element* named(std::string_view id) const;
  SvgCoordinates coordinates(const Element& e, const Properties& own) { return {e, own, viewport_, out_}; }
  Vec2 position_of(const Element& e, const Properties& own);

  const Element& root_;
  const SvgPage& page_;
  VectorLimits limits_;
  VectorRequest request_;
  std::size_t visited_ = 0;
  std::size_t dashed_ = 0;
  Vec2 viewport_;
  Cascade cascade_;
  std::map<std::string_view, const Element*> named_;
  std::vector<const Element*> in_use_;
  bool in_hole_ = false;  ///< everything is an area, however it is painted
  bool in_mask_ = false;
  DrawnLines out_;
};

}  // namespace telekerf::vision
