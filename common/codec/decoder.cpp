// SPDX-License-Identifier: Apache-2.0
#include "common/codec/decoder.h"

#include <algorithm>
#include <cmath>

#include "common/codec/button_bits.h"
#include "common/codec/codec_table.h"

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

}  // namespace

struct BlockDecoder::State {
  DecodedPacket packet;
  std::array<Samples, kMaxBlocks> samples;
  std::array<Successor, kAxes> next;
  ReplayWindow window;
  CodecCounters counters;
  std::uint64_t concealed = 0;

  // Concealment goes on from here: where the stream ended, how it moved, and how much of that is left.
  Vec3 last_sample = Vec3::Zero();
  Vec3 last_slope = Vec3::Zero();
  bool has_last = false;

  AxisContext context(const PacketHead& head, const Grid& grid, int age, int axis,
                      const Trend& trend) const noexcept;
  bool read_block(BitReader& in, const PacketHead& head, int age, const Trend& trend) noexcept;
  void remember_end() noexcept;
};

AxisContext BlockDecoder::State::context(const PacketHead& head, const Grid& grid, int age, int axis,
                                         const Trend& trend) const noexcept {
  AxisContext known;
  known.anchored = head.anchored;
  known.adaptive = head.adaptive;
  known.model = head.model;
  known.newest = age == 0;
  known.next = next[static_cast<std::size_t>(axis)];
  if (known.newest && head.anchored) {
    known.trend_level = on_grid(trend.value[axis], grid.level);
    known.trend_slope = on_grid(trend.slope_per_sample[axis], grid.slope);
  }
  return known;
}

bool BlockDecoder::State::read_block(BitReader& in, const PacketHead& head, int age,
                                     const Trend& trend) noexcept {
  auto& out = packet.blocks_newest_first[static_cast<std::size_t>(age)];
  const auto room =
      std::span(samples[static_cast<std::size_t>(age)]).first(static_cast<std::size_t>(head.block));
  out.button = read_button(in, head.block);
  out.samples = room;
  for (auto& sample : room) sample.setZero();

  const AxisCodec& codec = *find_codec(head.kind);  // read_head() has seen to it that there is one
  const Grid grid(head.block, head.quantum_exponent, head.integrated);
  std::array<double, kMaxBlock> axis_room;
  const auto axis_samples = std::span(axis_room).first(room.size());
  for (int a = 0; a < head.axes; ++a) {
    auto& start = next[static_cast<std::size_t>(a)];
    if (!codec.read(in, context(head, grid, age, a, trend), grid, start, axis_samples)) return false;
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
  s.remember_end();
  return &s.packet;
}

void BlockDecoder::State::remember_end() noexcept {
  const auto& newest = packet.blocks_newest_first[0];
  const auto size = newest.samples.size();
  const auto span = std::min<std::size_t>(size - 1, 4);
  last_sample = newest.samples[size - 1];
  last_slope.setZero();
  // Only a position moves on by itself; a force or acceleration is best held.
  if (packet.head.anchored && span > 0) {
    last_slope = (last_sample - newest.samples[size - 1 - span]) / static_cast<double>(span);
  }
  has_last = true;
}

const DecodedPacket* BlockDecoder::conceal() noexcept {
  auto& s = *state_;
  if (!s.has_last) return nullptr;
  const auto size = static_cast<std::size_t>(s.packet.head.block);
  const double fade = std::exp(-1.0 / static_cast<double>(size));
  for (std::size_t n = 0; n < size; ++n) {
    s.last_slope *= fade;
    s.last_sample += s.last_slope;
    s.samples[0][n] = s.last_sample;
  }
  s.packet.blocks = 1;
  s.packet.block_size = s.packet.head.block;
  s.packet.concealed = true;
  s.packet.blocks_newest_first[0] = {std::span<const Vec3>(s.samples[0]).first(size), 0};
  ++s.concealed;
  return &s.packet;
}
std::uint64_t BlockDecoder::concealed() const noexcept { return state_->concealed; }

const CodecCounters& BlockDecoder::counters() const noexcept { return state_->counters; }
void BlockDecoder::reset() noexcept {
  state_->window = {};
  state_->has_last = false;
}

}  // namespace telekerf::codec
