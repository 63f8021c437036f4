// SPDX-License-Identifier: Apache-2.0
// What the page and its server say to each other. Little endian; lengths in metres on the contour as it was
// published, times of the page in its own milliseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/runtime/vectors.h"

namespace telekerf::master {

/// Page -> server, binary, 32 bytes: on every movement, and every 20 ms while something is held.
struct PageFrame {
  static constexpr std::uint8_t kType = 1, kVersion = 1;
  static constexpr std::uint16_t kHeld = 1, kTrigger = 2;
  std::uint8_t type = kType;
  std::uint8_t version = kVersion;
  std::uint16_t flags = 0;     ///< kHeld: the hand pulls; kTrigger: the laser is wanted
  std::uint32_t sequence = 0;  ///< from 1 in each lease, one more each time
  double page_ms = 0.0;        ///< event.timeStamp
  float x_m = 0.0F;            ///< of the pointer
  float y_m = 0.0F;
  float pressure = 0.0F;    ///< 0 to 1, as far as the device knows
  std::uint32_t lease = 0;  ///< as the server gave it
};

/// None: another size, type or version, or a number that is none.
std::optional<PageFrame> parse_frame(std::span<const std::byte> bytes) noexcept;

/// Page -> server, JSON: {"do": "engage"}, with a value where the kind has one.
struct PageCommand {
  enum class Kind : std::uint8_t {
    kTake,   ///< the hand; needs the token
    kLeave,  ///< lets go of it
    kEngage,
    kDisengage,
    kBeta,  ///< value
    kArm,   ///< value 1 or 0: the fire button counts
    kStop,  ///< anyone may
    kClearStop,
    kNetem,        ///< text: name of a shipped profile
    kLook,         ///< text: what is meant in the picture
    kTakeContour,  ///< the one that waits
    kZoom,         ///< value: share of the travel
    kRefocus,
    kMaterial,  ///< text: its name
    kDepth,     ///< value: wished, m; 0: none
    kStream,    ///< text: "law local", as master/stream_choice.h has it
    kRate,      ///< value: states a second
    kPing,      ///< value: page's time, comes back
  };
  Kind kind = Kind::kPing;
  double value = 0.0;
  std::string text;
};

/// None: no such command, or its value is none.
std::optional<PageCommand> parse_command(std::string_view json);

/// Server -> page: numbers of one moment, in the order of kPageFieldNames, as float32 behind a head of 24
/// bytes: type 1, version 1, their count (uint16), 0 (uint32), server's time (float64, ms), page time of the
/// newest frame that the master has acted on (float64, ms; NaN: none).
inline constexpr std::array kPageFieldNames{
    // Ages in s; -1: nothing was heard.
    "master_age_s", "slave_age_s",
    // The master.
    "mode", "beta", "tool_x_m", "tool_y_m", "speed_m_per_s", "off_line_m", "constraint_n", "hand_x_n",
    "hand_y_n", "corridor_m", "circle_is_line", "circle_x_m", "circle_y_m", "circle_radius_m",
    // The slave, as it was seen last and as it is predicted.
    "slave_x_m", "slave_y_m", "slave_speed_m_per_s", "predicted_x_m", "predicted_y_m", "laser_on",
    "interlock", "slave_mode", "tracking_m", "prediction_m",
    // The link.
    "round_trip_s", "playout_s", "lost", "command_bytes_per_s", "state_bytes_per_s",
    // The hand: what holds in the master's last step, and how long after the server heard of it.
    "held", "trigger", "step_s", "late_frames"};
inline constexpr std::size_t kPageFields = kPageFieldNames.size();
using PageFields = std::array<float, kPageFields>;

/// Place of a field; of a name that is none the program does not compile.
consteval std::size_t page_field(std::string_view name) {
  for (std::size_t n = 0; n < kPageFields; ++n) {
    if (kPageFieldNames[n] == name) return n;
  }
  throw "no field has this name";
}

std::string encode_state(const PageFields& fields, double server_ms, double echo_ms);
/// Server -> page: places that the beam has reached, from the one with number `first` on (0: the page forgets
/// those before). Head of 8 bytes: type 2, version 1, count (uint16), first (uint32); then float32 x, y.
std::string encode_mark(std::span<const Vec2> places_m, std::uint32_t first);
/// Server -> page: how deep the contour is cut, in equal pieces of its length from its first point on. Head
/// of 8 bytes: type 3, version 1, count (uint16), 0 (uint32); then float32, m.
std::string encode_depths(std::span<const float> depths_m);

}  // namespace telekerf::master
