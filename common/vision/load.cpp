// SPDX-License-Identifier: Apache-2.0
#include "common/vision/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "common/vision/raster/picture_file.h"
#include "common/vision/vector/vector_file.h"

namespace telekerf::vision {
namespace {

std::vector<Vec2> all_points(const std::vector<geometry::Polyline>& lines) {
  std::vector<Vec2> all;
  for (const auto& line : lines) all.insert(all.end(), line.points_m.begin(), line.points_m.end());
  return all;
}

std::string no_contour(std::size_t asked, std::size_t count) {
  return fmt::format(
      "--select {}: {}; they are numbered from 0, the largest", asked,
      count == 1 ? "there is contour 0 alone" : fmt::format("there are the contours 0 to {}", count - 1));
}

double size_of(const geometry::Polyline& line) { return geometry::bounding_box(line.points_m).size().norm(); }

tl::expected<LoadedContours, std::string> vector_contours(const std::string& path,
                                                          const LoadRequest& request) {
  auto drawing = read_vector_file(path, request.drawing);
  if (!drawing) return tl::unexpected(drawing.error());
  LoadedContours out;
  out.mode = "vector";
  out.why = "a vector drawing is its own path";
  out.unsupported = drawing->unsupported.sentence();
  std::vector<std::string> remarks = drawing->notes;
  if (!out.unsupported.empty()) remarks.push_back("not followed: " + out.unsupported);
  out.remarks = fmt::format("{}", fmt::join(remarks, "; "));
  if (!out.remarks.empty()) out.why += fmt::format("; {}", out.remarks);
  out.size_from = drawing->size_from;
  std::vector<std::size_t> order(drawing->contours.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> sizes;
  for (const auto& contour : drawing->contours) sizes.push_back(size_of(contour));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  for (const std::size_t i : order) {
    out.contours.push_back(std::move(drawing->contours[i]));
    out.labels.push_back({drawing->pens[i].layer, drawing->pens[i].colour, {}});
  }
  for (LeftOut& left : drawing->left_out) {
    out.left_out.push_back(std::move(left.line));
    out.left_out_labels.push_back({left.pen.layer, left.pen.colour, left.why});
  }
  out.selected = request.select;
  if (out.selected >= out.contours.size())
    return tl::unexpected(fmt::format("{}: {}", path, no_contour(request.select, out.contours.size())));
  const geometry::Polyline& chosen = out.contours[out.selected];
  if (request.scale.picture_height_m) {
    return tl::unexpected(
        fmt::format("{}: a drawing is stretched by its width only; leave out the height", path));
  }
  double gain = 1.0;
  if (request.scale.picture_width_m) {
    const double page = drawing->page_width_m > 0.0
                            ? drawing->page_width_m
                            : geometry::bounding_box(all_points(out.contours)).size().x();
    if (page > 0.0) gain = *request.scale.picture_width_m / page;
    out.size_from =
        fmt::format("the width of {:g} mm that was asked for", 1e3 * *request.scale.picture_width_m);
  }
  const std::vector<Vec2> fitted = request.fit_all ? all_points(out.contours) : chosen.points_m;
  const bool first_point = request.scale.anchor == AnchorMode::kFirstPoint;
  Vec2 anchor = first_point ? chosen.points_m.front() : geometry::bounding_box(fitted).centre();
  if (request.scale.anchor == AnchorMode::kImageCentre) {
    anchor = 0.5 * Vec2(drawing->page_width_m, -drawing->page_height_m);  // SVG's page hangs below its origin
  }
  if (request.scale.anchor == AnchorMode::kLowerLeft)
    anchor = geometry::bounding_box(all_points(out.contours)).min;
  for (auto* lines : {&out.contours, &out.left_out}) {
    for (geometry::Polyline& line : *lines) {
      for (Vec2& p : line.points_m) p = gain * (p - anchor);
    }
  }
  out.noise_m.assign(out.contours.size(), 0.0);
  return out;
}

/// What is said of a picture beyond its mode: what of it is left out, or was taken for what it is not.
std::string remarks_in(const std::string& why) {
  constexpr std::string_view kNext = "; ";
  const auto end = why.find(kNext);
  return end == std::string::npos ? "" : why.substr(end + kNext.size());
}

tl::expected<LoadedContours, std::string> contours_on_paper(const cv::Mat& image,
                                                            const LoadRequest& request) {
  if (request.scale.picture_width_m || request.scale.picture_height_m)
    return tl::unexpected<std::string>("--paper says how large the picture is; leave out --width-mm");
  const auto flat = flat_sheet(image, request.paper);
  if (!flat) return tl::unexpected(flat.error());
  LoadRequest on_sheet = request;
  on_sheet.paper = Paper::kNone;
  on_sheet.scale.metres_per_pixel = flat->metres_per_pixel;
  for (Vec2& p : on_sheet.pointing.at) p = flat->to_sheet(p);
  for (Vec2& p : on_sheet.pointing.away) p = flat->to_sheet(p);
  for (auto* p : {&on_sheet.extraction.start_px, &on_sheet.extraction.end_px})
    if (*p) *p = flat->to_sheet(**p);
  if (auto& box = on_sheet.pointing.box) {
    const Vec2 first = flat->to_sheet(box->head<2>());
    const Vec2 last = flat->to_sheet(box->head<2>() + box->tail<2>());
    *box << first.cwiseMin(last), (last - first).cwiseAbs();
  }
  auto out = contours_of(flat->picture, on_sheet);
  if (!out) return out;
  out->why += fmt::format("; size and perspective are those of the {} sheet", kPapers.word(request.paper));
  out->remarks = remarks_in(out->why);
  return out;
}

}  // namespace

tl::expected<LoadedContours, std::string> contours_of(const cv::Mat& image, const LoadRequest& request) {
  if (request.paper != Paper::kNone) return contours_on_paper(image, request);
  PictureRequest wanted{request.extraction, request.pointing};
  auto found = contours_in(image, wanted);
  if (found && request.smallest_m) {
    // The size of a pixel may depend on what is found; the largest contour stays the same.
    const Scale scale =
        scale_for(found->contours.front(), found->picture_width_px, found->picture_height_px, request.scale);
    wanted.extraction.min_size_px = *request.smallest_m / scale.metres_per_pixel;
    found = contours_in(image, wanted);
  }
  if (!found) return tl::unexpected(found.error());
  if (request.select >= found->contours.size())
    return tl::unexpected(no_contour(request.select, found->contours.size()));
  LoadedContours out;
  out.mode = kExtractionModes.word(found->mode);
  out.why = found->why;
  out.selected = request.select;
  out.contrast = found->contrast;
  out.picture_noise = found->noise;
  out.picture_width_px = found->picture_width_px;
  out.picture_height_px = found->picture_height_px;
  const PixelContour& chosen = found->contours[request.select];
  PixelContour all = chosen;
  for (std::size_t i = 0; i < found->contours.size(); ++i) {
    if (i == request.select) continue;
    const auto& others = found->contours[i].points_px;
    all.points_px.insert(all.points_px.end(), others.begin(), others.end());
  }
  const auto scale_of = [&](const PixelContour& fitted) {
    return scale_for(fitted, found->picture_width_px, found->picture_height_px, request.scale);
  };
  out.scale = scale_of(request.fit_all ? all : chosen);
  if (request.scale.anchor == AnchorMode::kLowerLeft) out.scale.anchor_px = scale_of(all).anchor_px;
  out.metres_per_pixel = out.scale.metres_per_pixel;
  if (found->left_out.small > 0) {
    out.why +=
        fmt::format("; {} of at most {:.2f} mm left out (--smallest-mm keeps them)",
                    found->left_out.small == 1 ? "1 small contour"
                                               : fmt::format("{} small contours", found->left_out.small),
                    1e3 * out.metres_per_pixel * found->left_out.largest_px);
  }
  out.remarks = remarks_in(out.why);
  for (const PixelContour& contour : found->contours) {
    out.contours.push_back(to_workpiece(contour, out.scale));
    out.noise_m.push_back(contour.noise_px * out.metres_per_pixel);
  }
  out.picture = image;
  out.size_from = request.scale.metres_per_pixel ? "the size of a pixel"
                  : request.scale.picture_width_m
                      ? "the width that was asked for"
                      : "fitted to the workspace: the picture does not say how large it is";
  return out;
}

tl::expected<LoadedContours, std::string> load_contours(const std::string& path, const LoadRequest& request) {
  if (is_vector_file(path)) {
    if (request.pointing.any() || request.paper != Paper::kNone || request.smallest_m) {
      return tl::unexpected(
          fmt::format("{}: a drawing says its lines itself; --at, --box, --not, --paper and --smallest-mm "
                      "are for pictures",
                      path));
    }
    return vector_contours(path, request);
  }
  const auto picture = read_picture(path);
  if (!picture) return tl::unexpected(picture.error());
  LoadRequest reduced = request;
  if (reduced.extraction.start_px) *reduced.extraction.start_px /= picture->reduction;
  if (reduced.extraction.end_px) *reduced.extraction.end_px /= picture->reduction;
  for (Vec2& p : reduced.pointing.at) p /= picture->reduction;
  for (Vec2& p : reduced.pointing.away) p /= picture->reduction;
  if (reduced.pointing.box) *reduced.pointing.box /= picture->reduction;
  if (reduced.scale.metres_per_pixel) *reduced.scale.metres_per_pixel *= picture->reduction;
  const bool sized = reduced.scale.metres_per_pixel || reduced.scale.picture_width_m;
  const std::optional<double> dpi = request.drawing.dpi ? request.drawing.dpi : picture->dpi;
  if (!sized && dpi) reduced.scale.metres_per_pixel = 25.4e-3 / *dpi * picture->reduction;
  auto out = contours_of(picture->image, reduced);
  if (out) out->reduction = picture->reduction;
  if (out && !sized && dpi) {
    out->size_from = request.drawing.dpi ? fmt::format("{:g} pixels an inch, as asked for", *dpi)
                                         : fmt::format("{:g} pixels an inch, as the file says", *dpi);
  }
  if (!out) return tl::unexpected(fmt::format("{}: {}", path, out.error()));
  return out;
}

}  // namespace telekerf::vision
