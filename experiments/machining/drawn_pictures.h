// SPDX-License-Identifier: Apache-2.0
// Pictures that are drawn where they are wanted: in place of the thesis' photographs of figures 8.4 and 8.5,
// which nobody has.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace telekerf::experiments {

/// outline-N: an irregular outline of seed N, dark on grey. eight-leg-cam: a machine part with eight legs, as
/// from CAD. melanoma-like: a dark, mottled spot with a ragged, soft border on skin. tissue-like: a reddish
/// lump with a gloss on mucous membrane. hand-drawn: a closed stroke of a pen on paper in uneven light. Empty
/// for any other name.
cv::Mat drawn_picture(const std::string& name);

}  // namespace telekerf::experiments
