// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/deadband.h"

#include <algorithm>
#include <cmath>

#include "common/codec/baselines/time_domain.h"
#include "common/codec/run_length.h"

namespace telekerf::codec {
namespace {

constexpr int kWidestBand = 12;  // half octaves tried above and below the promised error

const auto write_held = [](auto& out, const AxisCode& code, int) noexcept {
  out.signed_golomb(code.values[0], kFirstOrder);
  write_runs(out, code);
};

Band band_of(double threshold, bool weber) noexcept {
  return weber ? Band{.absolute = 0.0, .relative = threshold} : Band{.absolute = threshold, .relative = 0.0};
}

CodedAxis encode(std::span<double> samples, const EncoderTools& tools, bool weber) noexcept {
  const StreamSettings& settings = tools.settings;
  AxisCode code;
  code.step_offset = min_step_offset(samples, tools.grid);
  const double step = tools.grid.step(code.step_offset);
  bool kept = false;
  if (settings.max_rms == 0.0) {
    kept = code.step_offset == 0;  // only an adaptive stream tells another step
    if (kept) hold_within(samples, band_of(settings.threshold, weber), step, code);
    return coded_or_raw(code, kept, samples, tools, write_held);
  }
  double largest = 0.0;
  for (const double x : samples) largest = std::max(largest, std::abs(x));
  for (int widen = kWidestBand; widen >= -kWidestBand && !kept; --widen) {
    const double band = Grid::fractional_power(settings.max_rms, 2 * widen);
    // Weber: the fraction that makes this band at the block's largest sample.
    const double threshold = weber && largest > 0.0 ? band / largest : band;
    kept = hold_within(samples, band_of(threshold, weber), step, code) <= allowed_energy(samples, settings);
  }
  return coded_or_raw(code, kept, samples, tools, write_held);
}

void write(BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid&,
           int block) noexcept {
  write_multiples(out, axis.code, context.adaptive, block, write_held);
}

bool read(BitReader& in, const AxisContext& context, const Grid& grid, Successor&,
          std::span<double> samples) noexcept {
  return read_multiples(
      in, context.adaptive, grid, samples, [](BitReader& body, AxisCode& code, int block) noexcept {
        code.values[0] = body.signed_golomb(kFirstOrder);
        return !body.failed() && std::abs(code.values[0]) <= kMaxValue && read_runs(body, code, block);
      });
}

}  // namespace

const AxisCodec kDeadbandCodec{
    .kind = kDeadband,
    .step_per_rms = kTimeDomainStepPerRms,
    .encode = [](std::span<double> samples, const EncoderTools& tools,
                 const AxisContext&) noexcept { return encode(samples, tools, false); },
    .write = write,
    .read = read,
};
const AxisCodec kWeberCodec{
    .kind = kWeber,
    .step_per_rms = kTimeDomainStepPerRms,
    .encode = [](std::span<double> samples, const EncoderTools& tools,
                 const AxisContext&) noexcept { return encode(samples, tools, true); },
    .write = write,
    .read = read,
};

}  // namespace telekerf::codec
