// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect codec: what a codec makes of a trace.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "common/codec/baselines/measure.h"
#include "common/protocol/overhead.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

struct Options {
  std::string trace;
  std::string codec = "sdct";
  std::string decoded;
  std::vector<std::string> columns;
  codec::StreamSettings stream{.redundancy = 0, .anchored = false};
  codec::PacketLoss link;
  double rate_hz = 1000.0;
};

int run(const Options& options) {
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= 1e6)) {
    throw StartupError(fmt::format("--rate-hz {}: must lie within [1, 1e6]", options.rate_hz));
  }
  const auto trace = codec::read_trace(options.trace, options.rate_hz, options.columns);
  const auto settings = codec::with_codec(options.stream, options.codec).validated();
  codec::Trace decoded;
  const auto figures = codec::measure(trace, settings, options.link, &decoded);
  if (!options.decoded.empty()) codec::write_trace(options.decoded, decoded);

  nlohmann::ordered_json report;
  report["trace"] = trace.name;
  report["columns"] = trace.columns;
  report["samples"] = figures.samples;
  report["rate_hz"] = options.rate_hz;
  report["codec"] = options.codec;
  report["block"] = settings.block;
  if (settings.max_rms > 0) {
    report["max_rms"] = settings.max_rms;
  } else {
    report["keep"] = settings.keep;
  }
  report["redundancy"] = settings.redundancy;
  report["loss"] = options.link.loss;
  report["bits_per_sample"] = figures.bits_per_sample;
  report["packet_bytes"] = figures.packet_bytes;
  report["overhead_bytes"] = static_cast<double>(kDatagramBytes);
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

}  // namespace

void add_codec_command(CLI::App& app, Action& action) {
  auto* command =
      app.add_subcommand("codec", "Sends a trace through a codec: bits, bytes on the wire, error, delay");
  auto options = std::make_shared<Options>();
  auto& stream = options->stream;
  command->add_option("trace", options->trace, "CSV file, columns of numbers")->required();
  command->add_option("--codec", options->codec, "which one")
      ->check(CLI::IsMember(codec::codec_names()))
      ->capture_default_str();
  command->add_option("--block", stream.block, "samples a block, 4 to 64")->capture_default_str();
  auto* keep = command->add_option("--keep", stream.keep, "coefficients kept an axis and block")
                   ->capture_default_str();
  command->add_option("--max-rms", stream.max_rms, "RMS error that no block exceeds, in the trace's unit")
      ->excludes(keep);
  command->add_option("--quantum", stream.quantum, "finest step (with --keep, and of the time-domain codecs)")
      ->capture_default_str();
  command->add_option("--threshold", stream.threshold, "dead-band: absolute, or weber's fraction");
  command->add_option("--rate-hz", options->rate_hz, "samples a second")->capture_default_str();
  command->add_option("--columns", options->columns, "names of the columns to take; default all")
      ->delimiter(',');
  command->add_flag("--anchored", stream.anchored,
                    "packets carry position and velocity of their newest block");
  command->add_option("--redundancy", stream.redundancy, "previous blocks repeated in a packet")
      ->capture_default_str();
  command->add_option("--loss", options->link.loss, "share of packets lost")->capture_default_str();
  command->add_option("--burst", options->link.burst, "mean length of a burst of losses, packets")
      ->capture_default_str();
  command->add_option("--seed", options->link.seed, "of the losses")
      ->check(whole_number())
      ->capture_default_str();
  command->add_option("--decoded", options->decoded, "CSV file for what the receiver has in the end");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace telekerf::inspect
