// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "common/codec/baselines/deadband.h"
#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/protocol/overhead.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

constexpr std::size_t kGroup = 3;
constexpr std::size_t kPacketRoom = Payload::kCapacity;

double nanoseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One stream's way through the link.
class Run {
 public:
  Run(const Trace& trace, std::size_t first, const StreamSettings& settings, Trace& decoded)
      : trace_(trace), first_(first), settings_(settings), decoded_(decoded), encoder_(settings) {
    block_ = static_cast<std::size_t>(settings_.block);
    samples_.resize(block_);
  }

  void operator()(const PacketLoss& link, CodingResult& figures, std::vector<double>& encode_ns,
                  std::vector<double>& decode_ns) {
    const auto blocks = trace_.size() / block_;
    const auto lost = lose(blocks, link);
    state_.assign(blocks, State::kMissing);
    std::vector<std::uint8_t> packet(kPacketRoom);
    for (std::size_t b = 0; b < blocks; ++b) {
      take(b);
      const auto trend = trend_at(b);
      const auto before_encode = std::chrono::steady_clock::now();
      const auto size = encoder_.encode(samples_, 0, trend, packet);
      encode_ns.push_back(nanoseconds_since(before_encode));
      if (!size) {
        state_[b] = State::kRefused;
        ++figures.refused_blocks;
        continue;
      }
      ++figures.packets;
      figures.copies += encoder_.copies();
      figures.packet_bytes += static_cast<double>(*size);
      figures.wire_bytes_per_s += frame_bytes(b, std::span(packet).first(*size), trend);
      figures.bits_per_sample += static_cast<double>(encoder_.newest_block_bits());
      if (lost[b]) {
        ++figures.lost;
        if (const auto* made_up = decoder_.conceal()) put(b, *made_up, 0);
        continue;
      }
      const auto before_decode = std::chrono::steady_clock::now();
      const auto got = decoder_.decode(std::span(packet).first(*size), trend);
      decode_ns.push_back(nanoseconds_since(before_decode));
      if (!got) throw std::logic_error(fmt::format("own packet refused: {}", to_string(got.error())));
      for (int age = 0; age < (*got)->blocks; ++age) put(b - static_cast<std::size_t>(age), **got, age);
    }
    for (const auto state : state_) {
      if (state == State::kMissing) figures.concealed_samples += block_;
    }
  }

  bool refused(std::size_t sample) const { return state_[sample / block_] == State::kRefused; }

 private:
  enum class State : std::uint8_t { kMissing, kReceived, kRefused };

  void take(std::size_t b) {
    for (std::size_t n = 0; n < block_; ++n) {
      samples_[n].setZero();
      for (int a = 0; a < settings_.axes; ++a) {
        samples_[n][a] = trace_.values[first_ + static_cast<std::size_t>(a)][b * block_ + n];
      }
    }
  }
  /// As the master sends it, with an echo of an equally long stream.
  double frame_bytes(std::size_t b, std::span<const std::uint8_t> packet, const Trend& trend) {
    const std::int64_t block_ns = std::int64_t{settings_.sample_period_ns} * settings_.block;
    const auto stamp_ns = [&](std::size_t n) {
      return static_cast<std::int64_t>(n) * block_ns / 1000 * 1000;  // senders stamp in whole microseconds
    };
    CommandBlock block;
    block.sequence = static_cast<std::uint32_t>(b + 1);
    block.epoch = block.contour_id = block.engage = 1;
    block.first_tick = b * block_;
    block.sample_period_ns = settings_.sample_period_ns;
    block.engaged = true;
    block.engaged_before = 0x7F;
    block.anchor = {trend.value, trend.slope_per_sample * trace_.rate_hz};
    block.sent_ns = stamp_ns(b + 1);
    block.echo_sequence = static_cast<std::uint32_t>(b);
    block.echo_sent_ns = stamp_ns(b);
    block.payload.size = static_cast<std::uint16_t>(packet.size());
    std::copy(packet.begin(), packet.end(), block.payload.bytes.begin());
    return wire_(block);
  }
  Trend trend_at(std::size_t b) const {
    constexpr std::size_t kSpan = 4;
    Trend trend;
    if (!settings_.anchored) return trend;
    const auto at = b * block_;
    const auto before = at >= kSpan ? at - kSpan : 0;
    for (int a = 0; a < settings_.axes; ++a) {
      const auto& x = trace_.values[first_ + static_cast<std::size_t>(a)];
      trend.value[a] = static_cast<double>(static_cast<float>(x[at]));
      const auto span = static_cast<double>(std::max<std::size_t>(at - before, 1));
      trend.slope_per_sample[a] = static_cast<double>(static_cast<float>((x[at] - x[before]) / span));
    }
    return trend;
  }
  void put(std::size_t b, const DecodedPacket& packet, int age) {
    if (state_[b] == State::kReceived) return;
    if (!packet.concealed) state_[b] = State::kReceived;
    const auto& block = packet.blocks_newest_first[static_cast<std::size_t>(age)];
    for (std::size_t n = 0; n < block_; ++n) {
      for (int a = 0; a < settings_.axes; ++a) {
        decoded_.values[first_ + static_cast<std::size_t>(a)][b * block_ + n] = block.samples[n][a];
      }
    }
  }

  const Trace& trace_;
  std::size_t first_;
  StreamSettings settings_;
  Trace& decoded_;
  BlockEncoder encoder_;
  BlockDecoder decoder_;
  std::size_t block_ = 0;
  std::vector<Vec3> samples_;
  std::vector<State> state_;
  WireCost<CommandBlock> wire_;
};

struct ErrorSums {
  double squares = 0, velocity_squares = 0, largest = 0;
  std::size_t count = 0, velocity_count = 0;

  template <typename Skip>
  void add(const std::vector<double>& truth, const std::vector<double>& got, std::size_t samples,
           double rate_hz, Skip&& skip) {
    double last = 0;
    bool has_last = false;
    for (std::size_t n = 0; n < samples; ++n) {
      if (skip(n)) {
        has_last = false;
        continue;
      }
      const double error = got[n] - truth[n];
      squares += error * error;
      largest = std::max(largest, std::abs(error));
      ++count;
      if (has_last) {
        velocity_squares += std::pow((error - last) * rate_hz, 2);
        ++velocity_count;
      }
      last = error;
      has_last = true;
    }
  }
  void into(CodingResult& figures) const {
    figures.rmse = count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
    figures.max_error = largest;
    figures.velocity_rmse =
        velocity_count == 0 ? 0 : std::sqrt(velocity_squares / static_cast<double>(velocity_count));
  }
};

/// A packet of float32 a sample, only when an axis leaves its band: the dead-band codec as the literature has
/// it.
void measure_events(const Trace& trace, const StreamSettings& settings, Trace& decoded,
                    CodingResult& figures) {
  const bool weber = settings.kind == kWeber;
  const auto streams = (trace.values.size() + kGroup - 1) / kGroup;
  for (std::size_t g = 0; g < streams; ++g) {
    const auto end = std::min(trace.values.size(), (g + 1) * kGroup);
    std::vector<double> sent(trace.values.size());
    for (std::size_t n = 0; n < trace.size(); ++n) {
      bool send = n == 0;
      for (auto c = g * kGroup; c < end; ++c) {
        const double band = weber ? settings.threshold * std::abs(sent[c]) : settings.threshold;
        send = send || std::abs(trace.values[c][n] - sent[c]) > band;
      }
      if (send) {
        ++figures.packets;
        const auto axes = static_cast<double>(end - g * kGroup);
        figures.packet_bytes += 4 * axes;
        figures.bits_per_sample += 32 * axes;
      }
      for (auto c = g * kGroup; c < end; ++c) {
        if (send) sent[c] = static_cast<double>(static_cast<float>(trace.values[c][n]));
        decoded.values[c][n] = sent[c];
      }
    }
  }
}

}  // namespace

std::vector<bool> lose(std::size_t packets, const PacketLoss& link) {
  if (!(link.loss >= 0 && link.loss <= 0.9)) {
    throw configuration_error(fmt::format("loss = {}: must lie within [0, 0.9]", link.loss));
  }
  if (!(link.burst >= 1 && link.burst <= 1e6)) {
    throw configuration_error(fmt::format("burst = {}: must lie within [1, 1e6] packets", link.burst));
  }
  // Two bursts have a packet between them that arrives.
  if (const double most = link.burst / (link.burst + 1.0); link.loss > most) {
    throw configuration_error(
        fmt::format("loss = {:g} is too much for bursts of {:g} packets: at most {:g}; use a longer burst",
                    link.loss, link.burst, most));
  }
  std::mt19937_64 random(link.seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double to_good = 1.0 / link.burst;
  const double to_bad = link.loss / (link.burst * (1.0 - link.loss));
  std::vector<bool> lost(packets);
  bool bad = false;
  for (std::size_t i = 0; i < packets; ++i) {
    bad = bad ? uniform() >= to_good : uniform() < to_bad;
    lost[i] = bad;
  }
  return lost;
}

CodingResult measure(const Trace& trace, StreamSettings settings, const PacketLoss& link, Trace* decoded) {
  settings.sample_period_ns = static_cast<std::uint32_t>(std::llround(1e9 / trace.rate_hz));
  settings = settings.validated();
  Trace received = trace;
  for (auto& column : received.values) std::fill(column.begin(), column.end(), 0.0);
  CodingResult figures;
  std::vector<double> encode_ns, decode_ns;
  ErrorSums errors;
  const auto block = static_cast<std::size_t>(settings.block);
  figures.samples = trace.size() / block * block;
  if (figures.samples == 0) {
    throw configuration_error(
        fmt::format("{}: {} samples do not fill one block of {}", trace.name, trace.size(), block));
  }
  const bool events = block == 1 && (settings.kind == kDeadband || settings.kind == kWeber);
  if (events) {
    (void)lose(0, link);
    if (link.loss > 0)
      throw configuration_error("loss: a dead-band stream with block = 1 has no blocks to lose");
    measure_events(trace, settings, received, figures);
    for (std::size_t c = 0; c < trace.values.size(); ++c) {
      errors.add(trace.values[c], received.values[c], figures.samples, trace.rate_hz,
                 [](std::size_t) { return false; });
    }
  } else {
    for (std::size_t first = 0; first < trace.values.size(); first += kGroup) {
      auto one = settings;
      one.axes = static_cast<int>(std::min(kGroup, trace.values.size() - first));
      Run run(trace, first, one, received);
      auto per_stream = link;
      per_stream.seed += first;
      run(per_stream, figures, encode_ns, decode_ns);
      for (auto c = first; c < first + static_cast<std::size_t>(one.axes); ++c) {
        errors.add(trace.values[c], received.values[c], figures.samples, trace.rate_hz,
                   [&](std::size_t n) { return run.refused(n); });
      }
    }
  }
  errors.into(figures);
  const auto columns = static_cast<double>(trace.values.size());
  const auto streams = std::ceil(columns / kGroup);
  const double seconds = static_cast<double>(figures.samples) / trace.rate_hz;
  const auto packets = static_cast<double>(figures.packets);
  figures.bits_per_sample /= static_cast<double>(figures.samples) * columns;
  if (events) figures.wire_bytes_per_s = figures.packet_bytes + packets * kDatagramBytes;
  figures.frame_bytes = figures.wire_bytes_per_s / std::max(packets, 1.0);
  figures.wire_bytes_per_s /= seconds;
  figures.packet_bytes /= std::max(packets, 1.0);
  figures.copies /= std::max(packets, 1.0);
  figures.packets_per_s = packets / seconds;
  figures.raw_wire_bytes_per_s = trace.rate_hz * (streams * kDatagramBytes + 4 * columns);
  figures.latency_ms = 1e3 * (settings.block - 1) / trace.rate_hz;
  figures.recovery_latency_ms = 1e3 * settings.block * settings.redundancy / trace.rate_hz;
  figures.encode_ns = median(encode_ns);
  figures.decode_ns = median(decode_ns);
  if (decoded != nullptr) {
    for (auto& column : received.values) column.resize(figures.samples);
    *decoded = std::move(received);
  }
  return figures;
}

}  // namespace telekerf::codec
