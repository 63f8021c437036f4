// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/truncated_dct.h"

namespace telekerf::codec {
namespace {

AxisContext truncated(AxisContext context) noexcept {
  context.truncated = true;
  return context;
}

}  // namespace

const AxisCodec kTruncatedDctCodec{
    .kind = kTruncatedDct,
    .min_block = kMinTransform,
    .transforms = true,
    .step_per_rms = kTransformStepPerRms,
    .encode =
        [](std::span<double> samples, const EncoderTools& tools, const AxisContext& context) noexcept {
          return encode_sdct(samples, tools, truncated(context));
        },
    .write = [](BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid& grid,
                int block) noexcept { write_sdct(out, axis, truncated(context), grid, block); },
    .read =
        [](BitReader& in, const AxisContext& context, const Grid& grid, Successor& start,
           std::span<double> samples) noexcept {
          return read_sdct(in, truncated(context), grid, start, samples);
        },
};

}  // namespace telekerf::codec
