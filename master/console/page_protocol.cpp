// SPDX-License-Identifier: Apache-2.0
#include "master/console/page_protocol.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace telekerf::master {
namespace {

using Json = nlohmann::json;
using Kind = PageCommand::Kind;

static_assert(std::endian::native == std::endian::little, "frames are little endian");
static_assert(sizeof(PageFrame) == 32, "frames hold no padding");

constexpr float kFarthest_m = 10.0F;
constexpr std::size_t kLongestText = 200;

struct CommandRow {
  std::string_view word;
  Kind kind;
  bool value = false;
  bool text = false;
};
constexpr CommandRow kCommands[] = {
    {"take", Kind::kTake, false, true},
    {"leave", Kind::kLeave},
    {"engage", Kind::kEngage},
    {"disengage", Kind::kDisengage},
    {"beta", Kind::kBeta, true},
    {"arm", Kind::kArm, true},
    {"stop", Kind::kStop},
    {"clear-stop", Kind::kClearStop},
    {"netem", Kind::kNetem, false, true},
    {"look", Kind::kLook, false, true},
    {"take-contour", Kind::kTakeContour},
    {"zoom", Kind::kZoom, true},
    {"refocus", Kind::kRefocus},
    {"material", Kind::kMaterial, false, true},
    {"depth", Kind::kDepth, true},
    {"stream", Kind::kStream, false, true},
    {"rate", Kind::kRate, true},
    {"ping", Kind::kPing, true},
};

template <class T>
void append(std::string& bytes, const T& value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

void append_head(std::string& bytes, std::uint8_t type, std::size_t count, std::uint32_t word) {
  append(bytes, type);
  append(bytes, PageFrame::kVersion);
  append(bytes, static_cast<std::uint16_t>(count));
  append(bytes, word);
}

}  // namespace

std::optional<PageFrame> parse_frame(std::span<const std::byte> bytes) noexcept {
  PageFrame frame;
  if (bytes.size() != sizeof(frame)) return std::nullopt;
  std::memcpy(&frame, bytes.data(), sizeof(frame));
  const auto near = [](float m) { return std::abs(m) <= kFarthest_m; };  // false for NaN
  if (frame.type != PageFrame::kType || frame.version != PageFrame::kVersion || !near(frame.x_m) ||
      !near(frame.y_m) || !(frame.page_ms >= 0.0 && frame.page_ms < 1e12) ||
      !(frame.pressure >= 0.0F && frame.pressure <= 1.0F)) {
    return std::nullopt;
  }
  return frame;
}

std::optional<PageCommand> parse_command(std::string_view json) {
  const Json said = Json::parse(json, nullptr, false);
  if (!said.is_object()) return std::nullopt;
  const auto word = said.find("do");
  if (word == said.end() || !word->is_string()) return std::nullopt;
  for (const CommandRow& row : kCommands) {
    if (row.word != word->get_ref<const std::string&>()) continue;
    PageCommand command{.kind = row.kind, .value = 0.0, .text = {}};
    if (row.value) {
      const auto value = said.find("value");
      if (value == said.end() || !value->is_number()) return std::nullopt;
      command.value = value->get<double>();
    }
    if (row.text) {
      const auto text = said.find("text");
      if (text == said.end() || !text->is_string() ||
          text->get_ref<const std::string&>().size() > kLongestText)
        return std::nullopt;
      command.text = text->get<std::string>();
    }
    return command;
  }
  return std::nullopt;
}

std::string encode_state(const PageFields& fields, double server_ms, double echo_ms) {
  std::string bytes;
  bytes.reserve(24 + sizeof(fields));
  append_head(bytes, 1, fields.size(), 0);
  append(bytes, server_ms);
  append(bytes, echo_ms);
  append(bytes, fields);
  return bytes;
}

std::string encode_mark(std::span<const Vec2> places_m, std::uint32_t first) {
  std::string bytes;
  bytes.reserve(8 + 8 * places_m.size());
  append_head(bytes, 2, places_m.size(), first);
  for (const Vec2& place : places_m) {
    append(bytes, static_cast<float>(place.x()));
    append(bytes, static_cast<float>(place.y()));
  }
  return bytes;
}

std::string encode_depths(std::span<const float> depths_m) {
  std::string bytes;
  bytes.reserve(8 + 4 * depths_m.size());
  append_head(bytes, 3, depths_m.size(), 0);
  for (const float depth_m : depths_m) append(bytes, depth_m);
  return bytes;
}

}  // namespace telekerf::master
