// SPDX-License-Identifier: Apache-2.0
// An experiment's figures as a page can carry them: a small picture, and the panels over time as data to zoom
// into.
#pragma once

#include <filesystem>
#include <string>

namespace telekerf::experiments {

/// `text` with what HTML takes for markup replaced.
std::string html_text(const std::string& text);

/// A data address that holds the picture as WebP, at most `width_px` wide. Throws StartupError if there is
/// none.
std::string picture_address(const std::filesystem::path& png, int width_px);

/// Folds with a plot each, of the panels in NAME.csv beside the figure whose x axis is a time; empty: there
/// are none.
std::string zoomable_panels(const std::filesystem::path& png);

}  // namespace telekerf::experiments
