// SPDX-License-Identifier: Apache-2.0
#include "master/console/console_words.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/codec/codec_table.h"
#include "common/runtime/version.h"
#include "common/workpiece/material.h"
#include "master/console/console.h"
#include "master/law.h"
#include "master/observer/estimators.h"
#include "master/operator_requests.h"

namespace telekerf::master {
namespace {

using Json = nlohmann::json;

template <typename Value>
Json words_of(const EnumTable<Value>& table) {
  Json words = Json::array();
  for (const auto& row : table) words.push_back(row.word);
  return words;
}

template <typename Value>
Json word_at(const EnumTable<Value>& table, std::size_t row) {
  return row < table.rows().size() ? Json(table.rows()[row].word) : Json();
}

}  // namespace

Json stream_words(const std::optional<StreamChoice>& stream) {
  if (!stream) return {};
  return {{"law", word_at(kLaws, stream->law)},
          {"estimator", word_at(kEstimators, stream->estimator)},
          {"codec", word_at(codec::kCodecs, stream->codec)},
          {"block", stream->block},
          {"keep", stream->keep},
          {"redundancy", stream->redundancy}};
}

Json picture_words(const CellView& cell) {
  Json pictures = Json::object();
  for (const auto& [contour, picture] : cell.pictures()) {
    pictures[std::to_string(contour)] = {{"number", picture.number},
                                         {"left_m", picture.preview.left_m},
                                         {"top_m", picture.preview.top_m},
                                         {"width_m", picture.preview.width_m},
                                         {"height_m", picture.preview.height_m}};
  }
  return pictures;
}

std::string hello_words(const ConsoleSettings& settings) {
  return Json{
      {"type", "hello"},
      {"version", kVersion},
      {"cell", settings.cell},
      {"fields", kPageFieldNames},
      {"profiles", settings.profiles},
      {"beta", {kSmallestBeta, kLargestBeta}},
      {"materials", words_of(workpiece::kMaterials)},
      {"stream",
       {{"law", words_of(kLaws)}, {"estimator", words_of(kEstimators)}, {"codec", words_of(codec::kCodecs)}}}}
      .dump();
}

std::string contour_words(const ContourMessage* found) {
  if (found == nullptr) return R"({"id":0})";
  const ContourMessage& contour = *found;
  const auto points = [](const std::vector<Vec2>& line_m) {
    Json all = Json::array();
    for (const Vec2& point : line_m) {  // um are enough for eyes
      all.push_back(std::round(point.x() * 1e7) / 1e7);
      all.push_back(std::round(point.y() * 1e7) / 1e7);
    }
    return all;
  };
  Json further = Json::array();
  for (const ContourLine& line : contour.further)
    further.push_back({{"closed", line.closed}, {"points", points(line.points_m)}});
  return Json{{"id", contour.id},     {"closed", contour.closed},           {"source", contour.source},
              {"mode", contour.mode}, {"points", points(contour.points_m)}, {"further", std::move(further)}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace telekerf::master
