// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/raw.h"

#include "common/codec/raw_samples.h"

namespace telekerf::codec {

const AxisCodec kRawCodec{
    .kind = kRaw,
    .encode =
        [](std::span<double> samples, const EncoderTools& tools, const AxisContext&) noexcept {
          CodedAxis axis;
          axis.code = raw_code(samples);
          reconstruct(axis.code, tools.grid, {}, samples);
          return axis;
        },
    .write = [](BitWriter& out, const CodedAxis& axis, const AxisContext&, const Grid&,
                int block) noexcept { write_raw_samples(out, axis.code, block); },
    .read = [](BitReader& in, const AxisContext&, const Grid&, Successor&,
               std::span<double> samples) noexcept { return read_raw_samples(in, samples); },
};

}  // namespace telekerf::codec
