// SPDX-License-Identifier: Apache-2.0
#include "common/codec/decoder.h"

#include "common/codec/axis_bits.h"

namespace telekerf::codec {
namespace {

/// Which of the last 64 sequence numbers were accepted.
class ReplayWindow {
 public:
  bool is_replay(std::uint16_t sequence) const noexcept {
    const int ahead = distance(sequence);
    return started_ && ahead <= 0 && ahead > -kWindow && ((seen_ >> -ahead) & 1) != 0;
  }
  void accept(std::uint16_t sequence) noexcept {
    const int ahead = distance(sequence);
    if (!started_ || ahead <= -kWindow || ahead >= kWindow) {
      seen_ = 1;
      last_ = sequence;
      started_ = true;
    } else if (ahead > 0) {
      seen_ = (seen_ << ahead) | 1;
      last_ = sequence;
    } else {
      seen_ |= std::uint64_t{1} << -ahead;
    }
  }

 private:
  static constexpr int kWindow = 64;
  int distance(std::uint16_t sequence) const noexcept {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(sequence - last_));
  }
  std::uint64_t seen_ = 0;
  std::uint16_t last_ = 0;
  bool started_ = false;
};

using Samples = std::array<Vec3, kMaxBlock>;

bool read_raw_block(BitReader& in, std::span<Vec3> samples) noexcept {
  for (int a = 0; a < kAxes; ++a) {
    for (auto& sample : samples) {
      const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(in.bits(32)));
      if (!(std::abs(value) <= static_cast<float>(kMaxMagnitude))) return false;
      sample[a] = static_cast<double>(value);
    }
  }
  return !in.failed();
}

}  // namespace

struct BlockDecoder::State {
  DecodedPacket packet;
  std::array<Samples, kMaxBlocks> samples;
  std::array<Successor, kAxes> next;
  ReplayWindow window;
  CodecCounters counters;

  bool read_block(BitReader& in, const PacketHead& head, int age, const Trend& trend) noexcept;
};

bool BlockDecoder::State::read_block(BitReader& in, const PacketHead& head, int age,
                                     const Trend& trend) noexcept {
  auto& out = packet.blocks_newest_first[static_cast<std::size_t>(age)];
  const auto room =
      std::span(samples[static_cast<std::size_t>(age)]).first(static_cast<std::size_t>(head.block));
  out.button = read_button(in, head.block);
  out.samples = room;
  if (head.kind == CodecKind::kRaw) return read_raw_block(in, room);

  const Grid grid(head.block, head.quantum_exponent);
  const auto& dct = Dct::of_size(head.block);
  std::array<double, kMaxBlock> axis_room;
  const auto axis_samples = std::span(axis_room).first(room.size());
  for (int a = 0; a < kAxes; ++a) {
    const auto at = static_cast<std::size_t>(a);
    AxisContext known;
    known.anchored = head.anchored;
    known.nominal = head.nominal;
    known.newest = age == 0;
    known.next = next[at];
    if (known.newest && head.anchored) {
      known.trend_level = on_grid(trend.value[a], grid.level);
      known.trend_slope = on_grid(trend.slope_per_sample[a], grid.slope);
    }
    AxisCode code;
    if (!read_axis(in, code, known, grid, dct, axis_samples)) return false;
    next[at] = successor_of(code, grid, axis_samples);
    for (std::size_t n = 0; n < room.size(); ++n) room[n][a] = axis_samples[n];
  }
  return true;
}

BlockDecoder::BlockDecoder() : state_(std::make_unique<State>()) { (void)Dct::of_size(kMinTransform); }
BlockDecoder::~BlockDecoder() = default;
BlockDecoder::BlockDecoder(BlockDecoder&&) noexcept = default;
BlockDecoder& BlockDecoder::operator=(BlockDecoder&&) noexcept = default;

tl::expected<const DecodedPacket*, CodecError> BlockDecoder::decode(std::span<const std::uint8_t> bytes,
                                                                    const Trend& trend) noexcept {
  auto& s = *state_;
  const auto refuse = [&](CodecError error) {
    s.counters.count(error);
    s.packet.blocks = 0;
    return tl::unexpected(error);
  };
  if (!is_finite(trend)) return refuse(CodecError::kNotFinite);
  BitReader in(bytes);
  const auto head = read_head(in);
  if (!head) return refuse(head.error());
  if (s.window.is_replay(head->sequence)) return refuse(CodecError::kReplayed);
  for (int age = 0; age < head->blocks; ++age) {
    if (!s.read_block(in, *head, age, trend)) {
      return refuse(in.truncated() ? CodecError::kTruncated : CodecError::kMalformed);
    }
  }
  if (in.truncated()) return refuse(CodecError::kTruncated);
  if (!in.at_clean_end()) return refuse(CodecError::kMalformed);
  s.window.accept(head->sequence);
  s.packet.head = *head;
  s.packet.blocks = head->blocks;
  s.packet.block_size = head->block;
  s.packet.concealed = false;
  ++s.counters.good;
  return &s.packet;
}

const CodecCounters& BlockDecoder::counters() const noexcept { return state_->counters; }
void BlockDecoder::reset() noexcept { state_->window = {}; }

}  // namespace telekerf::codec
