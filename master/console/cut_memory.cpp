// SPDX-License-Identifier: Apache-2.0
#include "master/console/cut_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "master/console/depth_plan.h"
#include "master/console/mark_trail.h"

namespace telekerf::master {
namespace {

constexpr std::array kMagic{'t', 'k', 'c', 'u', 't', '2', '\n', '\0'};
constexpr std::chrono::milliseconds kPeriod{200};

constexpr double kUnsaid = -1.0;

struct Head {
  std::array<char, 8> magic = kMagic;
  std::uint32_t contour_id = 0;
  std::uint32_t slave_epoch = 0;
  std::uint32_t places = 0;
  std::uint32_t pieces = 0;
  std::array<char, 16> material{};  ///< its name, filled up with zeros; empty: nobody has said
  double depth_m = kUnsaid;
};
static_assert(sizeof(Head) == 48, "the file holds no padding");

template <class T>
void add_raw(std::string& bytes, const T& value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

/// The next one of what is left, which is long enough.
template <class T>
T next_raw(std::string_view& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  bytes.remove_prefix(sizeof(T));
  return value;
}

}  // namespace

std::string text_of(const CutSoFar& cut) {
  std::string bytes;
  bytes.reserve(sizeof(Head) + 8 * (cut.places_m.size() + cut.lit_s.size()));
  Head head{.contour_id = cut.contour_id,
            .slave_epoch = cut.slave_epoch,
            .places = static_cast<std::uint32_t>(cut.places_m.size()),
            .pieces = static_cast<std::uint32_t>(cut.lit_s.size()),
            .depth_m = cut.wish.depth_m.value_or(kUnsaid)};
  if (cut.wish.material != nullptr) cut.wish.material->name.copy(head.material.data(), head.material.size());
  add_raw(bytes, head);
  for (const Vec2& place : cut.places_m) {
    add_raw(bytes, static_cast<float>(place.x()));
    add_raw(bytes, static_cast<float>(place.y()));
  }
  for (const double lit_s : cut.lit_s) add_raw(bytes, lit_s);
  return bytes;
}

std::optional<CutSoFar> parse_cut(std::string_view bytes) {
  if (bytes.size() < sizeof(Head)) return std::nullopt;
  const auto head = next_raw<Head>(bytes);
  if (head.magic != kMagic || head.places > MarkTrail::kMost || head.pieces > DepthTrail::kMostPieces ||
      bytes.size() != 8U * head.places + sizeof(double) * head.pieces)
    return std::nullopt;
  CutSoFar cut{.contour_id = head.contour_id, .slave_epoch = head.slave_epoch, .places_m = {}, .lit_s = {}, .wish = {}};
  const auto end = std::find(head.material.begin(), head.material.end(), '\0');
  if (end != head.material.begin()) {
    const auto material = workpiece::kMaterials.find(std::string(head.material.begin(), end));
    if (!material) return std::nullopt;
    cut.wish.material = *material;
  }
  if (head.depth_m >= 0.0 && head.depth_m <= DepthWish::kDeepest_m)
    cut.wish.depth_m = head.depth_m;
  else if (head.depth_m != kUnsaid)
    return std::nullopt;
  for (std::uint32_t n = 0; n < head.places; ++n) {
    const auto x_m = next_raw<float>(bytes), y_m = next_raw<float>(bytes);
    if (!std::isfinite(x_m) || !std::isfinite(y_m)) return std::nullopt;
    cut.places_m.emplace_back(x_m, y_m);
  }
  for (std::uint32_t n = 0; n < head.pieces; ++n) {
    cut.lit_s.push_back(next_raw<double>(bytes));
    if (!(cut.lit_s.back() >= 0.0) || !std::isfinite(cut.lit_s.back())) return std::nullopt;
  }
  return cut;
}

CutMemory::CutMemory(std::string path, std::function<void(const std::string&)> complain)
    : path_(std::move(path)), complain_(std::move(complain)) {
  if (!path_.empty()) writing_.emplace(kPeriod, [this] { write(); });
}

CutMemory::~CutMemory() {
  writing_.reset();
  write();
}

std::optional<CutSoFar> CutMemory::found() const {
  std::ifstream in(path_, std::ios::binary);
  if (path_.empty() || !in) return std::nullopt;
  return parse_cut(std::string(std::istreambuf_iterator<char>(in), {}));
}

void CutMemory::keep(const CutSoFar& cut) {
  if (path_.empty()) return;
  std::string text = text_of(cut);
  const std::lock_guard lock(mutex_);
  newest_ = std::move(text);
}

void CutMemory::write() {
  std::optional<std::string> text;
  {
    const std::lock_guard lock(mutex_);
    text = std::exchange(newest_, std::nullopt);
  }
  if (!text) return;
  try {
    write_atomically(path_, *text);
  } catch (const StartupError& error) {
    if (!std::exchange(complained_, true))
      complain_(fmt::format("the mark of what is cut will be gone after a restart of the console: {}", error.what()));
  }
}

}  // namespace telekerf::master
