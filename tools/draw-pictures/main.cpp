// SPDX-License-Identifier: Apache-2.0
// Draws the shipped pictures anew: draw-pictures FOLDER.
#include <fmt/format.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"
#include "tools/draw-pictures/rendering.h"

namespace {

int draw_all(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::uint64_t seed = 11;
  for (const std::string& name : telekerf::drawing::names()) {
    const auto drawing = telekerf::drawing::by_name(name);
    // Pen strokes look like paper under a lamp, regions like prints.
    telekerf::drawing::Appearance appearance;
    appearance.seed = seed++;
    appearance.ink = drawing->filled ? 62.0 : 48.0;
    appearance.shading = drawing->filled ? 12.0 : 30.0;
    appearance.grain = 1.5;
    appearance.noise = 1.5;
    appearance.blur_px = 1.0;
    const std::filesystem::path file = folder / (name + ".png");
    if (!cv::imwrite(file.string(), telekerf::drawing::render(*drawing, appearance),
                     {cv::IMWRITE_PNG_COMPRESSION, 9})) {
      throw telekerf::StartupError(fmt::format("{}: cannot be written", file.string()));
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return telekerf::run_program(
      argc, argv, "draw-pictures", "Draws the shipped test pictures", std::string(),
      [](std::string& folder, telekerf::Settings& settings) {
        settings.add("folder", folder, telekerf::kFolder, "where the PNG files go").as_argument();
      },
      draw_all);
}
