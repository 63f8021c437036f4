// SPDX-License-Identifier: Apache-2.0
// What pages are told in words, as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "master/console/cell_view.h"
#include "master/stream_choice.h"

namespace telekerf::master {

struct ConsoleSettings;

/// Once, at the beginning: which fields, networks, materials, laws, estimators and codecs there are.
std::string hello_words(const ConsoleSettings& settings);
/// Points in metres, x and y in turns; {"id":0}: null.
std::string contour_words(const ContourMessage* contour);
/// By the words of the settings; null: nobody has told it. A row that this program does not know is null.
nlohmann::json stream_words(const std::optional<StreamChoice>& stream);
/// By the contour in whose frame each lies: its number and its edges, m.
nlohmann::json picture_words(const CellView& cell);

}  // namespace telekerf::master
