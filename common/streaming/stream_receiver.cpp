// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/stream_receiver.h"

#include <algorithm>

namespace telekerf::streaming {
namespace {

/// A stamp further ahead than this of what the elapsed time allows is a broken or hostile clock.
constexpr double kFuture_s = 1.0;

/// Accelerations have no straight line through them; their anchor is for the reference.
codec::Trend trend_of(const CommandHeader& header) noexcept {
  if (header.law != Law::kLocal) return {};
  return {header.anchor.position_m, header.anchor.velocity_m_per_s * (header.sample_period_ns * 1e-9)};
}
codec::Trend trend_of(const StateHeader& header) noexcept {
  return {header.anchor.position_m, header.anchor.velocity_m_per_s * (header.sample_period_ns * 1e-9)};
}

/// Samples of both are comparable.
bool same_source(const CommandHeader& a, const CommandHeader& b) noexcept {
  return a.beta == b.beta && a.law == b.law;
}
bool same_source(const StateHeader& /*a*/, const StateHeader& /*b*/) noexcept { return true; }

/// Samples of both are counted alike.
template <class Header>
bool same_count(const Header& a, const Header& b) noexcept {
  return a.sample_period_ns == b.sample_period_ns && a.ticks_per_sample == b.ticks_per_sample;
}

template <class Header>
std::int64_t first_index(const Header& header) noexcept {
  return static_cast<std::int64_t>(header.first_tick / header.ticks_per_sample);
}

/// A block's number may be ahead by what the elapsed time allows, and this many blocks: delay that becomes
/// less.
constexpr double kFutureBlocks = 64.0;
/// A sender whose blocks all count as overtaken for this long has begun to count anew.
constexpr double kLease_s = 1.0;

/// What any arithmetic with it relies on.
template <class Header>
bool within_bounds(const Header& header) noexcept {
  constexpr std::uint32_t kShortest_ns = 10'000, kLongest_ns = 100'000'000;
  constexpr std::uint16_t kMostTicks = 1000;
  constexpr double kLongest_s = 1e9;  // thirty years: nanoseconds of it are far from 63 bits
  return header.sample_period_ns >= kShortest_ns && header.sample_period_ns <= kLongest_ns &&
         header.ticks_per_sample >= 1 && header.ticks_per_sample <= kMostTicks &&
         static_cast<double>(header.first_tick) / header.ticks_per_sample * header.sample_period_ns <
             1e9 * kLongest_s;
}

/// By how many numbers `a` is ahead of `b`, around the end of 32 bits.
std::int32_t ahead(std::uint32_t a, std::uint32_t b) noexcept { return static_cast<std::int32_t>(a - b); }

}  // namespace

template <class Block>
Arrival StreamReceiver<Block>::refuse() noexcept {
  ++counters_.refused;
  return {.kind = Arrival::Kind::kRefused};
}

template <class Block>
void StreamReceiver<Block>::begin_anew() noexcept {
  heard_ = false;
  answered_ = false;
  foreign_ns_.reset();
  decoder_.reset();
}

template <class Block>
bool StreamReceiver<Block>::too_far_ahead(const Header& header, std::int64_t first,
                                          std::int64_t now_ns) const noexcept {
  const double sample_s = 1e-9 * header.sample_period_ns;
  const double passed_s = silent_s(now_ns);
  return static_cast<double>(first - newest_) * sample_s > passed_s + kFuture_s ||
         ahead(header.sequence, header_.sequence) > passed_s / (block_size_ * sample_s) + kFutureBlocks;
}

template <class Block>
Arrival StreamReceiver<Block>::receive(const Received<Block>& received, std::int64_t useful_from,
                                       std::optional<std::uint32_t> contour_id, bool answers) noexcept {
  const Block& block = received.value;
  const bool first_answer = answers && !answered_;
  if (heard_ && block.epoch != header_.epoch) {
    if (!first_answer && !(silent_s(received.received_ns) > silence_s_)) {
      foreign_ns_ = received.received_ns;
      return refuse();
    }
    begin_anew();
  }
  if (!within_bounds<Header>(block)) return refuse();
  if (contour_id && block.contour_id != *contour_id) return refuse();
  // Whoever has said nothing acceptable for so long may have begun to count anew, or the one before was a
  // forger.
  const bool given_up = first_answer || silent_s(received.received_ns) > std::max(silence_s_, kLease_s);
  if (heard_ && ahead(block.sequence, header_.sequence) <= 0) {
    if (!given_up) return overtaken(block, useful_from);
    begin_anew();
  }
  const std::int64_t first = first_index(block);
  if (heard_ && same_count<Header>(block, header_) && too_far_ahead(block, first, received.received_ns)) {
    if (!given_up) return refuse();
    begin_anew();
  }
  const bool begins = !heard_ || !same_count<Header>(block, header_);
  const auto decoded = decoder_.decode(block.payload.view(), trend_of(block));
  if (!decoded) return refuse();

  Arrival arrival{.kind = Arrival::Kind::kNew, .begins = begins, .first = first, .packet = *decoded};
  if (heard_) arrival.missing = block.sequence - header_.sequence - 1;
  if (begins) {
    first_sequence_ = block.sequence;
    newest_ = -1;
  }
  if (begins || !same_source(block, header_)) ++generation_;
  counters_.lost += arrival.missing;
  ++counters_.blocks;
  newest_ = std::max(newest_, first + arrival.packet->block_size - 1);
  block_size_ = arrival.packet->block_size;
  header_ = block;
  arrived_ns_ = received.received_ns;
  heard_ = true;
  answered_ = answered_ || answers;
  return arrival;
}

template <class Block>
Arrival StreamReceiver<Block>::overtaken(const Block& block, std::int64_t useful_from) noexcept {
  Arrival arrival{.kind = Arrival::Kind::kStale, .first = first_index(block)};
  const bool counted_lost = ahead(block.sequence, first_sequence_) > 0;
  if (counted_lost && same_count<Header>(block, header_) && same_source(block, header_) &&
      arrival.first + codec::kMaxBlock - 1 >= useful_from) {
    // What comes twice is refused by the decoder.
    if (const auto decoded = decoder_.decode(block.payload.view(), trend_of(block))) {
      arrival.kind = Arrival::Kind::kLate;
      arrival.packet = *decoded;
      --counters_.lost;
      ++counters_.blocks;
      return arrival;
    }
  }
  ++counters_.stale;
  return arrival;
}

template class StreamReceiver<CommandBlock>;
template class StreamReceiver<StateBlock>;

}  // namespace telekerf::streaming
