// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/contour_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/runtime/refusal.h"
#include "common/runtime/resources.h"
#include "common/vision/load.h"

namespace telekerf::vision {

ContourMessage find_contour(const ContourRequest& request) {
  const std::string file = find_resource("pictures", request.image, ".png").string();
  const auto mode = mode_of(request.mode);
  if (!mode) throw Refusal(fmt::format("mode = {}: must be auto, outline, stroke or thesis", request.mode));
  LoadRequest load;
  load.extract.mode = *mode;
  load.scale.picture_width_m = request.width_m;
  load.scale.workspace_radius_m = request.workspace_radius_m;
  const auto loaded = load_contours(file, load);
  if (!loaded) throw Refusal(loaded.error());

  const geometry::Polyline& line = loaded->contours[loaded->selected];
  double reach_m = 0.0;
  for (const auto& point : line.points_m) reach_m = std::max(reach_m, point.norm());
  if (reach_m > request.workspace_radius_m) {
    throw Refusal(
        fmt::format("{}: the contour reaches {:.1f} mm from its centre, but the slave's workspace only "
                    "{:.1f} mm; use a smaller --width-mm",
                    file, reach_m * 1e3, request.workspace_radius_m * 1e3));
  }
  ContourMessage message;
  message.id = 1;
  message.closed = line.closed;
  message.source = std::filesystem::path(file).filename().string();
  message.mode = loaded->mode;
  message.metres_per_pixel = loaded->metres_per_pixel;
  message.deviation_m = loaded->noise_m[loaded->selected];
  message.points_m = line.points_m;
  return message;
}

}  // namespace telekerf::vision
