// SPDX-License-Identifier: Apache-2.0
#include "common/codec/sdct.h"

#include <array>

namespace telekerf::codec {

CodedAxis encode_sdct(std::span<double> samples, const EncoderTools& tools,
                      const AxisContext& context) noexcept {
  CodedAxis axis;
  const PricedCode priced =
      tools.analyser.analyse(samples, {tools.settings.keep, tools.settings.max_rms}, context, tools.grid);
  axis.code = priced.code;
  axis.cost_bits = priced.cost_bits;
  std::array<double, kMaxBlock> shape_room;
  const auto shape = std::span(shape_room).first(samples.size());
  shape_of(axis.code, tools.grid, Dct::of_size(static_cast<int>(samples.size())), shape);
  axis.ends = ends_of(shape);
  reconstruct(axis.code, tools.grid, shape, samples);
  axis.start = successor_of(axis.code, tools.grid, samples);
  return axis;
}

void write_sdct(BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid& grid,
                int block) noexcept {
  write_axis(out, axis.code, axis.ends, context, grid, block);
}

bool read_sdct(BitReader& in, const AxisContext& context, const Grid& grid, Successor& start,
               std::span<double> samples) noexcept {
  AxisCode code;
  if (!read_axis(in, code, context, grid, Dct::of_size(static_cast<int>(samples.size())), samples))
    return false;
  start = successor_of(code, grid, samples);
  return true;
}

}  // namespace telekerf::codec
