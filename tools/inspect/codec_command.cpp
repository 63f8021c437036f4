// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect codec: what a codec makes of a trace.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "common/codec/baselines/measure.h"
#include "common/codec/codec_table.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

struct CodecOptions {
  std::string trace;
  codec::CodecChoice codec = codec::kDefaultCodec;
  std::string decoded;
  std::vector<std::string> columns;
  codec::StreamSettings stream{.redundancy = 0, .anchored = false};
  std::optional<int> keep;
  std::optional<double> max_rms;
  codec::PacketLoss link;
  double rate_hz = 1000.0;
};

int run_codec(const CodecOptions& options) {
  if (options.keep && options.max_rms) throw usage_error("--keep and --max-rms: give one of them");
  const auto trace = codec::read_trace(options.trace, options.rate_hz, options.columns);
  codec::StreamSettings stream = options.stream;
  stream.keep = options.keep.value_or(stream.keep);
  stream.max_rms = options.max_rms.value_or(0.0);
  const auto settings = codec::with_codec(stream, options.codec).validated();
  codec::Trace decoded;
  const auto figures = codec::measure(trace, settings, options.link, &decoded);
  if (!options.decoded.empty()) codec::write_trace(options.decoded, decoded);

  nlohmann::ordered_json report;
  report["trace"] = trace.name;
  report["columns"] = trace.columns;
  report["samples"] = figures.samples;
  report["rate_hz"] = options.rate_hz;
  report["codec"] = codec::kCodecs.word(options.codec);
  report["block"] = settings.block;
  if (settings.max_rms > 0) {
    report["max_rms"] = settings.max_rms;
  } else {
    report["keep"] = settings.keep;
  }
  report["redundancy"] = settings.redundancy;
  report["copies"] = figures.copies;
  report["loss"] = options.link.loss;
  report["bits_per_sample"] = figures.bits_per_sample;
  report["packet_bytes"] = figures.packet_bytes;
  report["overhead_bytes"] = figures.frame_bytes - figures.packet_bytes;
  report["packets_per_s"] = figures.packets_per_s;
  report["wire_bytes_per_s"] = figures.wire_bytes_per_s;
  report["raw_wire_bytes_per_s"] = figures.raw_wire_bytes_per_s;
  report["wire_ratio"] = figures.raw_wire_bytes_per_s / figures.wire_bytes_per_s;
  report["rmse"] = figures.rmse;
  report["max_error"] = figures.max_error;
  report["velocity_rmse"] = figures.velocity_rmse;
  report["latency_ms"] = figures.latency_ms;
  report["recovery_latency_ms"] = figures.recovery_latency_ms;
  report["packets"] = figures.packets;
  report["lost_packets"] = figures.lost;
  report["concealed_samples"] = figures.concealed_samples;
  report["refused_blocks"] = figures.refused_blocks;
  report["encode_ns"] = figures.encode_ns;
  report["decode_ns"] = figures.decode_ns;
  fmt::print("{}\n", json_text(report));
  return 0;
}

void add_codec_parameters(CodecOptions& o, Settings& s) {
  auto& stream = o.stream;
  s.add("trace", o.trace, kFile, "CSV, columns of numbers").as_argument();
  s.add("codec", o.codec, codec::kCodecs, "which one");
  s.add("block", stream.block, {.min = 1, .max = 64}, "samples a block; 4 or more of a transform");
  s.add("keep", o.keep, {.min = 1, .max = 64},
        fmt::format("coefficients kept an axis and block; without max_rms {}", stream.keep));
  s.add("max_rms", o.max_rms, {.min = 0, .max = 1e6},
        "RMS error that no block exceeds, in the trace's unit, instead of keep");
  s.add("quantum", stream.quantum, {.min = 1e-15, .max = 1e6},
        "finest step; with max_rms it follows from that");
  s.add("threshold", stream.threshold, {.min = 0, .max = 1e6}, "dead-band: absolute, or weber's fraction");
  s.add("rate_hz", o.rate_hz, {.min = 1, .max = 1e6, .unit = "Hz"}, "samples a second");
  s.add("columns", o.columns, kName, "of the columns to take; without it all");
  s.add("anchored", stream.anchored, "packets carry position and velocity of their newest block");
  s.add("redundancy", stream.redundancy, {.min = 0, .max = 7}, "previous blocks repeated in a packet");
  s.add("loss", o.link.loss, {.min = 0, .max = 1}, "packets lost, as a fraction");
  s.add("burst", o.link.burst, {.min = 1, .max = 1e6}, "mean length of a burst of losses, packets");
  s.add("seed", o.link.seed, kSeeds, "of the losses");
  s.add("decoded", o.decoded, kFile, "CSV for what the receiver has in the end");
  codec::refuse_unread(s, {""});
  s.only_with({"threshold"}, "codec", {"deadband", "weber"});
  s.not_with({"quantum"}, "codec", {"raw", "batched"});
  s.only_with({"quantum", "threshold"}, "max_rms", {"0"});
  s.only_with({"anchored"}, "codec", {"sdct"});
  s.not_with({"burst", "seed"}, "loss", {"0"});
}

}  // namespace

void add_codec_command(Program& program) {
  program.add("codec", "Sends a trace through a codec: bits, bytes on the wire, error, delay", CodecOptions{},
              add_codec_parameters, run_codec);
}

}  // namespace telekerf::inspect
