// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/path_data.h"

#include <cctype>
#include <cmath>
#include <utility>

#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

char capital(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

}  // namespace

std::optional<PathSegment> PathData::next() {
  skip_separators(rest_);
  if (rest_.empty() || damaged_) return std::nullopt;
  PathSegment s;
  s.from = s.to = s.a = s.b = at_;
  damaged_ = !take_command() || !take_operands(s);
  if (damaged_) return std::nullopt;
  at_ = s.to;
  return s;
}

/// A letter; where there is none the last one is meant again.
bool PathData::take_command() {
  if (std::isalpha(static_cast<unsigned char>(rest_.front())) == 0)
    return command_ != 0 && capital(command_) != 'Z';
  command_ = rest_.front();
  rest_.remove_prefix(1);
  return true;
}

bool PathData::take_operands(PathSegment& s) {
  using Kind = PathSegment::Kind;
  const char before = std::exchange(last_, capital(command_));
  const auto continued = [&](char kind, char smooth) {
    return before == kind || before == smooth ? Vec2(2.0 * at_ - control_) : at_;
  };
  if (before == 0 && last_ != 'M' && last_ != 'Z') return false;
  switch (last_) {
    case 'Z':
      s.kind = Kind::kClose;
      s.to = start_;
      return true;
    case 'M':
      s.kind = Kind::kMove;
      if (!take(s.to)) return false;
      start_ = s.to;
      command_ = command_ == 'm' ? 'l' : 'L';
      return true;
    case 'L':
      s.kind = Kind::kLine;
      return take(s.to);
    case 'H':
      s.kind = Kind::kLine;
      return take(s.to.x(), at_.x());
    case 'V':
      s.kind = Kind::kLine;
      return take(s.to.y(), at_.y());
    case 'C':
    case 'S':
      s.kind = Kind::kCubic;
      if (last_ == 'S') s.a = continued('C', 'S');
      if ((last_ == 'C' && !take(s.a)) || !take(s.b) || !take(s.to)) return false;
      control_ = s.b;
      return true;
    case 'Q':
    case 'T':
      s.kind = Kind::kQuadratic;
      if (last_ == 'T') s.a = continued('Q', 'T');
      if ((last_ == 'Q' && !take(s.a)) || !take(s.to)) return false;
      control_ = s.a;
      return true;
    case 'A':
      s.kind = Kind::kArc;
      return take_arc(s);
    default:
      return false;
  }
}

bool PathData::take_arc(PathSegment& s) {
  for (double* value : {&s.radii.x(), &s.radii.y(), &s.rotation_rad}) {
    const auto number = take_number(rest_);
    if (!number) return false;
    *value = *number;
  }
  s.rotation_rad = s.rotation_rad * M_PI / 180.0;
  for (bool* flag : {&s.large, &s.sweep}) {
    const auto digit = take_flag(rest_);
    if (!digit) return false;
    *flag = *digit;
  }
  return take(s.to);
}

/// A coordinate, relative to `origin` where the command is a small letter.
bool PathData::take(double& value, double origin) {
  const auto number = take_number(rest_);
  if (!number) return false;
  value = *number;
  if (std::islower(static_cast<unsigned char>(command_)) != 0) value += origin;
  return true;
}

void draw(const PathSegment& s, CurveWriter& w) {
  switch (s.kind) {
    case PathSegment::Kind::kLine:
      return w.line_to(s.to);
    case PathSegment::Kind::kQuadratic:
      return w.quadratic_to(s.a, s.to);
    case PathSegment::Kind::kCubic:
      return w.cubic_to(s.a, s.b, s.to);
    case PathSegment::Kind::kArc:
      return w.arc_to(s.radii, s.rotation_rad, s.large, s.sweep, s.to);
    case PathSegment::Kind::kMove:
    case PathSegment::Kind::kClose:
      return;
  }
}

}  // namespace telekerf::vision
