// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/dxf.h"

#include <fmt/format.h>

#include <iterator>

namespace telekerf::vision {

std::string to_dxf(std::span<const geometry::Polyline> contours) {
  // POLYLINE, which needs no handles: what every program reads.
  std::string out =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$"
      "MEASUREMENT\n70\n1\n0\nENDSEC\n"
      "0\nSECTION\n2\nENTITIES\n";
  auto to = std::back_inserter(out);
  for (const auto& line : contours) {
    fmt::format_to(to, "0\nPOLYLINE\n8\n0\n66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n70\n{}\n", line.closed ? 1 : 0);
    for (const Vec2& p : line.points_m)
      fmt::format_to(to, "0\nVERTEX\n8\n0\n10\n{:.6f}\n20\n{:.6f}\n30\n0.0\n", 1e3 * p.x(), 1e3 * p.y());
    out += "0\nSEQEND\n8\n0\n";
  }
  return out + "0\nENDSEC\n0\nEOF\n";
}

}  // namespace telekerf::vision
