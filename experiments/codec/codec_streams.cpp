// SPDX-License-Identifier: Apache-2.0
#include "experiments/codec/codec_streams.h"

#include <fmt/format.h>

#include <tuple>

#include "netem/core/profile.h"

namespace telekerf::experiments {

DelayResult coded_run(const HandRecord& hand, const std::string& codec, int block, int redundancy) {
  DelayTrial trial;
  trial.network = netem::load_profile("thesis-constant");
  trial.master.codec = codec::kCodecs.find(codec).value();
  trial.master.node.command.codec.block = block;
  trial.master.node.command.codec.redundancy = redundancy;
  return run_trial(hand, trial);
}

reporting::PageTable stream_table(const HandRecord& hand) {
  reporting::TableRows rows{{"command stream", "payload, bytes", "bytes/s", "below bare floats",
                             "below batched floats", "tracking, um rms"}};
  const auto blocks_per_s = [](int block) { return 1000.0 / block; };
  for (const auto& [block, redundancy] : {std::pair{16, 1}, {32, 2}}) {
    const DelayResult batched = coded_run(hand, "batched", block, redundancy);
    for (const char* codec : {"raw", "sdct"}) {
      const bool alone = std::string(codec) == "raw";
      if (alone && rows.size() > 1) continue;  // a packet a sample, whatever the block
      const DelayResult run = coded_run(hand, codec, block, redundancy);
      rows.push_back(
          {alone ? "raw, a block for each sample" : fmt::format("SDCT, N = {}, R = {}", block, redundancy),
           fmt::format("{:.0f}", run.payload_bytes_per_s / (alone ? 1000.0 : blocks_per_s(block))),
           fmt::format("{:.0f}", run.wire_bytes_per_s),
           fmt::format("{:.1f} x", kRawBytesPerS / run.wire_bytes_per_s),
           fmt::format("{:.1f} x", batched.wire_bytes_per_s / run.wire_bytes_per_s),
           fmt::format("{:.2f}", run.tracking_rmse_um)});
    }
  }
  return {"stream", reporting::markdown_table(rows)};
}

}  // namespace telekerf::experiments
