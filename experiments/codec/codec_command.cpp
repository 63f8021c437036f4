// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment codec: rate against distortion of every codec at equal latency, with the Gaussian
// limit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/codec/baselines/measure.h"
#include "common/protocol/overhead.h"
#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/codec/codec_rates.h"
#include "experiments/codec/codec_recordings.h"
#include "experiments/codec/codec_streams.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;
using reporting::Panel;

using Json = nlohmann::ordered_json;

constexpr int kLimitColour = 7;

struct Options : QuickForm {
  std::string out = "out/codec";
  std::string page;
  std::vector<std::string> traces;
  double rate_hz = 1000.0;
  double seconds = 20.0;
  std::uint64_t seed = 1;
};

Line line_of(const Curve& curve, Line::Style style, int colour) {
  Line line{"", {}, {}, style, colour};
  for (const auto& point : curve) {
    line.x.push_back(point.rmse);
    line.y.push_back(point.bits_per_sample);
  }
  return line;
}

Panel panel_for(const std::string& title, std::array<double, 2> errors) {
  Panel panel;
  panel.title = title;
  panel.x_label = "RMS error";
  panel.y_label = "bits a sample";
  panel.log_x = true;
  panel.x_range = errors;
  return panel;
}

/// What is held wears the colour of the codec that it uses.
Line::Style style_of(const Contender& contender) {
  return contender.held ? Line::Style::kDashed : Line::Style::kSolid;
}
int colour_of(std::size_t contender) { return kContenders[contender].held ? 4 : static_cast<int>(contender); }

/// The legend has a panel to itself: inside the others it would hide lines. From above in its order, each
/// line as it is drawn.
Panel legend() {
  Panel panel{.title = "what is what", .axes = false};
  const auto add = [&](const char* label, Line::Style style, int colour) {
    const double place = -static_cast<double>(panel.lines.size());
    panel.lines.push_back({label, {0, 1, 2}, {place, place, place}, style, colour});
  };
  for (std::size_t c = 0; c < kContenders.size(); ++c)
    add(kContenders[c].label, style_of(kContenders[c]), colour_of(c));
  add("Gaussian limit, block alone", Line::Style::kDashed, kLimitColour);
  add("Gaussian limit, any delay", Line::Style::kPoints, kLimitColour);
  panel.y_range = {-static_cast<double>(panel.lines.size()), 1.0};
  return panel;
}

Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e4) / 1e4;
}

/// One trace at one block length: a panel of the figure and its numbers.
Json rate_distortion(const SeededTrace& seeded, int block, Panel& panel) {
  std::vector<double> errors;
  for (int i = kSweepFrom; i <= kSweepTo; ++i) errors.push_back(seeded.fine * std::exp2(0.5 * i));
  const auto limit = gaussian_limit(block_variances_of(seeded.trace, block), errors);
  const auto endless = gaussian_limit(spectrum_of(seeded.trace), errors);
  std::vector<Curve> curves;
  curves.reserve(kContenders.size());
  for (const auto& contender : kContenders) curves.push_back(sweep(seeded, contender, block));

  panel = panel_for(fmt::format("{} [{}]", seeded.trace.name, seeded.unit), {errors.front(), errors.back()});
  double highest = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    panel.lines.push_back(line_of(curves[c], style_of(kContenders[c]), colour_of(c)));
    const double bits = kContenders[c].events ? 0 : bits_at(curves[c], seeded.fine);
    if (std::isfinite(bits)) highest = std::max(highest, bits);
  }
  panel.lines.push_back(line_of(limit, Line::Style::kDashed, kLimitColour));
  panel.lines.push_back(line_of(endless, Line::Style::kPoints, kLimitColour));
  panel.y_range = {0.0, 1.2 * highest};

  Json rows = Json::array();
  for (const double factor : {1.0, 4.0}) {
    const double rmse = factor * seeded.fine;
    Json row{{"trace", seeded.trace.name},
             {"block", block},
             {"noise_times", factor},
             {"rmse", rmse},
             {"unit", seeded.unit}};
    for (std::size_t c = 0; c < curves.size(); ++c)
      row["bits"][kContenders[c].label] = rounded(bits_at(curves[c], rmse));
    row["limit_block"] = rounded(bits_at(limit, rmse * 1.0000001));
    row["limit_any_delay"] = rounded(bits_at(endless, rmse * 1.0000001));
    row["sdct_minus_truncated_bits_a_block"] =
        rounded(block * (bits_at(curves[0], rmse) - bits_at(curves[3], rmse)));
    row["sdct_over_dpcm"] = rounded(bits_at(curves[0], rmse) / bits_at(curves[4], rmse));
    row["sdct_over_deadband"] = rounded(bits_at(curves[0], rmse) / bits_at(curves[5], rmse));
    row["sdct_over_deadband_floats"] = rounded(bits_at(curves[0], rmse) / bits_at(curves[7], rmse));
    rows.push_back(row);
  }
  return rows;
}

/// The command stream of the demo: what one packet layout costs with everything counted.
Json wire_row(const SeededTrace& seeded, const char* name, int block, int redundancy, double loss,
              double burst, std::uint64_t seed) {
  codec::StreamSettings s{.block = block, .redundancy = redundancy, .quantum = seeded.fine, .anchored = true};
  s = codec::with_codec(s, name);
  const auto figures = codec::measure(seeded.trace, s, {.loss = loss, .burst = burst, .seed = seed});
  const bool sample_by_sample = s.block == 1;
  // One packet of bare floats a sample.
  const double payload = sample_by_sample ? 12.0 : figures.packet_bytes;
  const double wire = sample_by_sample ? figures.raw_wire_bytes_per_s : figures.wire_bytes_per_s;
  return {{"trace", seeded.trace.name},
          {"codec", name},
          {"block", s.block},
          {"redundancy", s.redundancy},
          {"loss", loss},
          {"burst", burst},
          {"payload_bytes", rounded(payload)},
          {"wire_bytes_per_s", rounded(wire)},
          {"below_raw", rounded(figures.raw_wire_bytes_per_s / wire)},
          {"rmse", figures.rmse},
          {"max_error", figures.max_error},
          {"velocity_rmse", figures.velocity_rmse},
          {"concealed_samples", figures.concealed_samples},
          {"latency_ms", rounded(figures.latency_ms)}};
}

/// `positions` of docs/results/codec.md, of the rows of `wire`.
reporting::PageTable positions_table(const Json& wire) {
  reporting::TableRows table{{"position stream", "payload, bytes", "bytes/s", "below raw", "RMS error, um",
                              "velocity RMS error, mm/s"}};
  for (const auto& row : wire) {
    const auto name = row["codec"].get<std::string>();
    if (name != "sdct" && row["trace"] != "hand") continue;  // the same for every trace
    const std::string coding =
        name == "raw"
            ? "bare float32, sample by sample"
            : fmt::format("{}, N = {}, R = {}{}", name == "sdct" ? "SDCT, m = 4" : "batched float32",
                          row["block"].get<int>(), row["redundancy"].get<int>(),
                          name == "sdct" ? ", " + row["trace"].get<std::string>() : "");
    const auto error = [&](const char* which, double unit) {
      return name == "sdct" ? fmt::format("{:.2f}", row[which].get<double>() / unit) : std::string("-");
    };
    table.push_back({coding, fmt::format("{:.0f}", row["payload_bytes"].get<double>()),
                     fmt::format("{:.0f}", row["wire_bytes_per_s"].get<double>()),
                     fmt::format("{:.1f} x", row["below_raw"].get<double>()), error("rmse", 1e-6),
                     error("velocity_rmse", 1e-3)});
  }
  return {"positions", reporting::markdown_table(table)};
}

int run(const Options& options) {
  auto traces = seeded_traces(options.seconds, options.rate_hz, options.seed);
  const auto seeded = traces.size();
  for (auto& recorded : recorded_traces(options.seconds, options.seed)) traces.push_back(std::move(recorded));
  for (const auto& file : options.traces) {
    auto trace = codec::read_trace(file, options.rate_hz);
    const double fine = noise_of(trace);
    traces.push_back({std::move(trace), "its unit", fine, false});
  }
  make_folder("--out", options.out);
  Json results;
  for (const int block : {16, 32}) {
    Figure figure{
        fmt::format("Rate against distortion, blocks of {} decoded alone", block), {legend()}, 3, 420, 320};
    for (const auto& trace : traces) {
      Panel panel;
      for (auto& row : rate_distortion(trace, block, panel)) results["rate_distortion"].push_back(row);
      figure.panels.push_back(std::move(panel));
    }
    draw_figure(figure, std::filesystem::path(options.out) / fmt::format("rate-distortion-{}.png", block));
  }
  for (std::size_t i = 0; i < seeded; ++i) {
    const auto& trace = traces[i];
    if (trace.trace.name != "hand" && trace.trace.name != "contour") continue;
    for (const auto& [name, block, redundancy] : {std::tuple("raw", 1, 0),
                                                  {"batched", 16, 1},
                                                  {"sdct", 16, 1},
                                                  {"batched", 32, 2},
                                                  {"sdct", 32, 2}}) {
      results["wire"].push_back(wire_row(trace, name, block, redundancy, 0, 1, options.seed));
    }
    for (const double loss : {0.01, 0.05}) {
      for (const int redundancy : {0, 1, 2}) {
        results["loss"].push_back(wire_row(trace, "sdct", 16, redundancy, loss, 1.0, options.seed));
      }
    }
  }
  write_result(std::filesystem::path(options.out) / "codec.json", results, options.seed);
  if (!options.page.empty())
    reporting::write_tables(
        options.page, {rates_table(traces), stream_table(record_hand("heart", kStreamLap_s, options.seed)),
                       positions_table(results["wire"])});
  for (const auto& row : results["rate_distortion"]) {
    fmt::print(
        "{:<13} N {:<3} rmse {:<9.2g} SDCT {:<7} truncated {:<7} DPCM {:<7} dead-band {:<8} held {:<7} limit "
        "{}\n",
        row["trace"].get<std::string>(), row["block"].get<int>(), row["rmse"].get<double>(),
        row["bits"]["SDCT"].dump(), row["bits"]["truncated DCT"].dump(), row["bits"]["DPCM + Rice"].dump(),
        row["bits"]["dead-band"].dump(), row["bits"]["held samples, DPCM + Rice"].dump(),
        row["limit_block"].dump());
  }
  return 0;
}

}  // namespace

void add_codec_command(Program& program) {
  // The chapter's word, and the code's.
  for (const char* name : {"compression", "codec"}) {
    program.add(
        name, "Thesis 7.2.3: rate against distortion of every codec; codec.json and two figures", Options{},
        [](Options& o, Settings& s) {
          s.add("page", o.page, kFile, "results page whose table of rates is written anew");
          s.add("out", o.out, kFolder, "for the results");
          s.add("trace", o.traces, kFile, "CSV recordings to hold the codecs against as well");
          s.add("rate_hz", o.rate_hz, {.min = 100, .max = 1e5, .unit = "Hz"}, "samples a second");
          s.add("seconds", o.seconds, {.min = 5, .max = 600, .unit = "s"}, "length of the made-up traces");
          s.add("seed", o.seed, kSeeds, "of the made-up traces and losses");
          o.add_quick(s, {QuickForm::shorter("seconds", o.seconds, 5)}, {"page"});
        },
        run);
  }
}

}  // namespace telekerf::experiments
