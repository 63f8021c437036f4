// SPDX-License-Identifier: Apache-2.0
#include "experiments/codec/codec_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/codec/baselines/deadband.h"
#include "common/codec/baselines/measure.h"

namespace telekerf::experiments {
namespace {

codec::StreamSettings settings_for(const Contender& contender, int block, double error, double scale) {
  codec::StreamSettings s{.block = block, .keep = block, .redundancy = 0, .anchored = contender.anchored};
  if (contender.events) s.block = 1;
  s = codec::with_codec(s, contender.codec);
  if (contender.promised) {
    s.max_rms = error;
  } else if (s.kind == codec::kDeadband || s.kind == codec::kWeber) {
    // A held sample is off by up to the band, about band / sqrt(3) rms; the lattice adds little to that.
    s.threshold = s.kind == codec::kWeber ? 2 * error / scale : 2 * error;
    s.quantum = error;
  } else {
    s.quantum = std::sqrt(12.0) * error;
  }
  return s;
}

/// Every `every`-th sample of `trace`, and what holding them makes of the error.
RatePoint held(const codec::Trace& trace, const codec::StreamSettings& settings, int every) {
  const auto stride = static_cast<std::size_t>(every);
  codec::Trace thin{trace.name, trace.columns, {}, trace.rate_hz / every};
  for (const auto& column : trace.values) {
    auto& kept = thin.values.emplace_back();
    for (std::size_t n = 0; n < column.size(); n += stride) kept.push_back(column[n]);
  }
  codec::Trace decoded;
  const auto figures = codec::measure(thin, settings, {}, &decoded);
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t c = 0; c < trace.values.size(); ++c) {
    for (std::size_t n = 0; n < std::min(trace.size(), decoded.size() * stride); ++n, ++count) {
      squares += std::pow(trace.values[c][n] - decoded.values[c][n / stride], 2);
    }
  }
  return {std::sqrt(squares / static_cast<double>(count)), figures.bits_per_sample / every};
}

/// Only the points that no other beats in both error and bits, by error.
Curve best_of(Curve curve) {
  std::sort(curve.begin(), curve.end(), [](auto a, auto b) { return a.rmse < b.rmse; });
  Curve best;
  for (const auto& point : curve) {
    if (best.empty() || point.bits_per_sample < best.back().bits_per_sample) best.push_back(point);
  }
  return best;
}

constexpr const char* kColumns[] = {"SDCT", "truncated DCT", "DPCM + Rice", "dead-band"};

/// "0.5 um" of 5e-7 m, "9 mN" of 0.009 N: two digits, in the unit's thousandths that suit it.
std::string with_unit(double value, const std::string& unit) {
  if (unit == "m") return fmt::format("{:.2g} um", value * 1e6);
  if (unit == "N") return fmt::format("{:.2g} mN", value * 1e3);
  return unit == "1" ? fmt::format("{:.2g}", value) : fmt::format("{:.2g} {}", value, unit);
}

}  // namespace

Curve sweep(const SeededTrace& seeded, const Contender& contender, int block) {
  double squares = 0;
  for (const auto& column : seeded.trace.values) {
    for (const double x : column) squares += x * x;
  }
  const double scale =
      std::sqrt(squares / static_cast<double>(seeded.trace.size() * seeded.trace.values.size()));
  Curve curve;
  if (contender.held) {
    for (const int every : {2, 4, 8}) {
      for (int i = kSweepFrom - 6; i <= kSweepTo; ++i) {
        const double error = seeded.fine * std::exp2(0.5 * i);
        curve.push_back(held(seeded.trace, settings_for(contender, block / every, error, 1.0), every));
      }
    }
    return best_of(curve);
  }
  for (int i = kSweepFrom; i <= kSweepTo; ++i) {
    const auto figures = codec::measure(
        seeded.trace,
        settings_for(contender, block, seeded.fine * std::exp2(0.5 * i), std::max(scale, 1e-12)));
    curve.push_back({figures.rmse, figures.bits_per_sample});
  }
  std::sort(curve.begin(), curve.end(), [](auto a, auto b) { return a.rmse < b.rmse; });
  return curve;
}

double bits_at(const Curve& curve, double rmse) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (curve[i - 1].rmse <= rmse && rmse <= curve[i].rmse && curve[i - 1].rmse > 0) {
      const double part = std::log(rmse / curve[i - 1].rmse) / std::log(curve[i].rmse / curve[i - 1].rmse);
      return curve[i - 1].bits_per_sample + part * (curve[i].bits_per_sample - curve[i - 1].bits_per_sample);
    }
  }
  return std::nan("");
}

std::vector<RateRow> rate_rows() {
  std::vector<RateRow> rows;
  for (const char* trace : {"hand", "contour", "force", "acceleration", "chirp", "steps", "held", "noise",
                            "joints", "pen", "ecg", "current", "contact"}) {
    for (const double factor : {1.0, 4.0}) {
      for (const int block : {16, 32}) rows.push_back({trace, factor, block});
    }
  }
  for (const char* trace : {"demo-hand", "demo-tool", "demo-force", "demo-push"}) {
    for (const int block : {16, 32}) rows.push_back({trace, 1.0, block});
  }
  return rows;
}

std::vector<std::string> rate_cells(const SeededTrace& seeded, const RateRow& row) {
  const double rmse = row.factor * seeded.fine;
  std::vector<std::string> cells{seeded.trace.name + ", " + with_unit(rmse, seeded.unit),
                                 fmt::format("{}", row.block)};
  for (const char* column : kColumns) {
    const auto contender = std::find_if(kContenders.begin(), kContenders.end(),
                                        [&](const Contender& c) { return std::string(c.label) == column; });
    const double bits = bits_at(sweep(seeded, *contender, row.block), rmse);
    cells.push_back(std::isfinite(bits) ? fmt::format("{:.2f}", bits) : "-");
  }
  const Curve limit =
      gaussian_limit(block_variances_of(seeded.trace, row.block), {0.999 * rmse, 1.001 * rmse});
  cells.push_back(fmt::format("{:.2f}", bits_at(limit, rmse)));
  return cells;
}

reporting::PageTable rates_table(const std::vector<SeededTrace>& traces) {
  reporting::TableRows rows{
      {"trace, RMS error", "N", "SDCT", "truncated DCT", "DPCM + Rice", "dead-band", "limit"}};
  for (const RateRow& row : rate_rows()) {
    const auto trace = std::find_if(traces.begin(), traces.end(),
                                    [&](const SeededTrace& t) { return t.trace.name == row.trace; });
    rows.push_back(rate_cells(*trace, row));
  }
  return {"rates", reporting::markdown_table(rows)};
}

}  // namespace telekerf::experiments
