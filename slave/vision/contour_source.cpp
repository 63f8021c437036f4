// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/contour_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"

namespace telekerf::vision_process {
namespace {

/// Share of what the hand reaches that the bounding circle of a fitted contour takes: centred by its box, a
/// triangle reaches 15 % further, and there is a corridor beside it.
constexpr double kFillOfHand = 0.85;

}  // namespace

vision::LoadRequest load_request(const ContourRequest& request) {
  vision::LoadRequest load;
  load.extraction.mode = request.mode;
  load.scale.anchor = request.anchor;
  load.scale.picture_width_m = request.width_m;
  load.scale.workspace_radius_m = request.workspace_radius_m;
  if (request.hand_radius_m) {
    load.scale.fill =
        std::min(load.scale.fill, kFillOfHand * *request.hand_radius_m / request.workspace_radius_m);
  }
  load.fit_all = request.fit_all;
  load.select = request.select;
  load.extraction.start_px = request.start_px;
  load.extraction.end_px = request.end_px;
  request.picture.apply_to(load);
  load.drawing = request.drawing;
  return load;
}

tl::expected<ContourMessage, std::string> message_of(const vision::LoadedContours& loaded,
                                                     const std::string& source, double workspace_radius_m) {
  const geometry::Polyline& line = loaded.contours[loaded.selected];
  double reach_m = 0.0;
  for (const auto& point : line.points_m) reach_m = std::max(reach_m, point.norm());
  if (reach_m > workspace_radius_m) {
    return tl::unexpected(fmt::format(
        "{}: the contour reaches {:.1f} mm from the workspace's centre, but the slave only {:.1f} mm; "
        "use a smaller --width-mm",
        source, reach_m * 1e3, workspace_radius_m * 1e3));
  }
  ContourMessage message;
  message.closed = line.closed;
  message.source = source;
  message.mode = loaded.mode;
  message.metres_per_pixel = loaded.metres_per_pixel;
  message.deviation_m = loaded.noise_m[loaded.selected];
  message.points_m = line.points_m;
  std::size_t points = 0;
  for (std::size_t i = 0; i < loaded.contours.size(); ++i) {
    if (i == loaded.selected) continue;
    const geometry::Polyline& other = loaded.contours[i];
    points += other.size();
    // Largest first: what does not fit is dust.
    if (points > kMaxContourPoints || message.further.size() == kMaxContourLines) break;
    message.further.push_back({other.closed, other.points_m});
  }
  message.id = digest_of(message);
  return message;
}

ContourMessage find_contour(const ContourRequest& request) {
  const std::string file = find_resource("pictures", request.image, ".png").string();
  const auto loaded = vision::load_contours(file, load_request(request));
  if (!loaded) throw input_error(loaded.error());
  const auto message =
      message_of(*loaded, std::filesystem::path(file).filename().string(), request.workspace_radius_m);
  if (!message) throw input_error(message.error());
  return *message;
}

}  // namespace telekerf::vision_process
