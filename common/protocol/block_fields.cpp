// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/block_fields.h"

#include <bit>
#include <cmath>
#include <limits>

#include "common/protocol/wire_precision.h"

namespace telekerf {
namespace {

constexpr std::uint16_t kNoAge = std::numeric_limits<std::uint16_t>::max();
constexpr double kAgesPerSecond = 1e4;
constexpr std::int64_t kMicrosecond_ns = 1000;
constexpr std::int64_t kFarthest_us = 10'000'000;  // between two blocks

PayloadPrefix prefix_of(const Payload& payload, std::uint32_t number) noexcept {
  PayloadPrefix prefix;
  if (payload.size < kPayloadPrefixBytes) return prefix;
  prefix.present = true;
  std::copy_n(payload.bytes.begin(), kPayloadFormatBytes, prefix.format.begin());
  const unsigned sequence =
      static_cast<unsigned>(payload.bytes[kPayloadFormatBytes]) << 8 | payload.bytes[kPayloadFormatBytes + 1];
  prefix.offset = static_cast<std::uint16_t>(sequence - number);
  return prefix;
}
void put(ByteWriter& out, const PayloadPrefix& prefix) noexcept {
  out.put(prefix.present ? 1 : 0, 1);
  if (!prefix.present) return;
  out.put(prefix.format);
  out.put(prefix.offset, 2);
}
PayloadPrefix get_prefix(ByteReader& in) noexcept {
  PayloadPrefix prefix;
  prefix.present = in.get(1) != 0;
  if (!prefix.present) return prefix;
  const auto format = in.take(kPayloadFormatBytes);
  std::copy(format.begin(), format.end(), prefix.format.begin());
  prefix.offset = static_cast<std::uint16_t>(in.get(2));
  return prefix;
}

/// Ticks from one block to the next.
template <class Block>
Tick ticks_of(const Block& block, const PayloadPrefix& payload) noexcept {
  return static_cast<Tick>(payload.samples()) * block.ticks_per_sample;
}

template <class Block>
void put_common(ByteWriter& out, const Block& block, std::uint16_t contract) noexcept {
  const PayloadPrefix payload = prefix_of(block.payload, block.sequence);
  out.put(contract, 2);
  out.put(block.epoch, 4);
  out.put(block.sample_period_ns, 4);
  out.put(block.contour_id, 4);
  out.put(std::bit_cast<std::uint32_t>(static_cast<float>(block.beta)), 4);
  out.put(block.ticks_per_sample, 2);
  out.put(block.engage, 4);
  out.put(block.stop, 4);
  out.put(block.first_tick - block.sequence * ticks_of(block, payload), 8);
  put(out, payload);
}
template <class Block>
SetFrame get_common(ByteReader& in, Block& block) noexcept {
  SetFrame set;
  set.contract = static_cast<std::uint16_t>(in.get(2));
  block.epoch = static_cast<std::uint32_t>(in.get(4));
  block.sample_period_ns = static_cast<std::uint32_t>(in.get(4));
  block.contour_id = static_cast<std::uint32_t>(in.get(4));
  block.beta = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(in.get(4))));
  block.ticks_per_sample = static_cast<std::uint16_t>(in.get(2));
  block.engage = static_cast<std::uint32_t>(in.get(4));
  block.stop = static_cast<std::uint32_t>(in.get(4));
  set.base = in.get(8);
  set.payload = get_prefix(in);
  set.block_ns = std::int64_t{set.payload.samples()} * block.sample_period_ns;
  return set;
}

bool on_grid(const Anchor& anchor, std::array<std::int32_t, 6>& grid) noexcept {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  for (int i = 0; i < 3; ++i) {
    const double position = std::nearbyint(anchor.position_m[i] / kPositionGrid_m);
    const double velocity = std::nearbyint(anchor.velocity_m_per_s[i] / kVelocityGrid_m_per_s);
    if (!(std::abs(position) <= kMost && std::abs(velocity) <= kMost)) return false;
    grid[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(position);
    grid[static_cast<std::size_t>(i + 3)] = static_cast<std::int32_t>(velocity);
  }
  return true;
}
template <class Block>
bool common_of(const Block& block, CommonFields& fields) noexcept {
  fields.number = block.sequence;
  fields.sent_ns = block.sent_ns;
  fields.echo_number = block.echo_sequence;
  fields.echo_sent_ns = block.echo_sent_ns;
  return on_grid(block.anchor, fields.anchor);
}
template <class Block>
void apply_common(const CommonFields& fields, const SetFrame& set, Block& block) noexcept {
  block.sequence = fields.number;
  block.sent_ns = fields.sent_ns;
  block.echo_sequence = fields.echo_number;
  block.echo_sent_ns = fields.echo_sent_ns;
  block.first_tick = set.base + fields.number * ticks_of(block, set.payload);
  for (int i = 0; i < 3; ++i) {
    block.anchor.position_m[i] = kPositionGrid_m * fields.anchor[static_cast<std::size_t>(i)];
    block.anchor.velocity_m_per_s[i] = kVelocityGrid_m_per_s * fields.anchor[static_cast<std::size_t>(i + 3)];
  }
}

/// Without overflow, whatever the two are.
std::int64_t less(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
std::int64_t later(std::int64_t time_ns, std::int64_t by_us) noexcept {
  return less(time_ns, -kMicrosecond_ns * by_us);
}

/// The number nearest to `around` whose lowest `bytes` are these.
std::uint64_t nearest(std::uint64_t lowest, int bytes, std::uint64_t around) noexcept {
  const std::uint64_t window = std::uint64_t{1} << 8 * bytes;
  const std::uint64_t ahead = (lowest - around) & (window - 1);
  return ahead < window / 2 ? around + ahead : around + ahead - window;
}
std::uint64_t get_near(ByteReader& in, int bytes, std::uint64_t around) noexcept {
  return nearest(in.get(bytes), bytes, around);
}
std::int64_t get_time(ByteReader& in, int bytes, std::int64_t around_ns) noexcept {
  const auto around = static_cast<std::uint64_t>(around_ns / kMicrosecond_ns);
  return static_cast<std::int64_t>(get_near(in, bytes, around) * kMicrosecond_ns);
}
void put_time(ByteWriter& out, int bytes, std::int64_t time_ns) noexcept {
  out.put(static_cast<std::uint64_t>(time_ns / kMicrosecond_ns), bytes);
}
/// How long so many blocks take; at most some seconds, whatever the numbers.
std::int64_t lasting_us(std::uint32_t blocks, std::int64_t block_ns) noexcept {
  return std::clamp(static_cast<std::int32_t>(blocks) * (block_ns / kMicrosecond_ns), -kFarthest_us,
                    kFarthest_us);
}

void put_full_common(ByteWriter& out, const CommonFields& fields) noexcept {
  out.put(fields.number, 4);
  out.put(static_cast<std::uint64_t>(fields.sent_ns), 8);
  out.put(fields.echo_number, 4);
  out.put(static_cast<std::uint64_t>(fields.echo_sent_ns), 8);
  for (const std::int32_t value : fields.anchor) out.put(static_cast<std::uint32_t>(value), 4);
}
void get_full_common(ByteReader& in, CommonFields& fields) noexcept {
  fields.number = static_cast<std::uint32_t>(in.get(4));
  fields.sent_ns = in.get_signed(8);
  fields.echo_number = static_cast<std::uint32_t>(in.get(4));
  fields.echo_sent_ns = in.get_signed(8);
  for (std::int32_t& value : fields.anchor) value = static_cast<std::int32_t>(in.get_signed(4));
}

void put_short_common(ByteWriter& out, const CommonFields& fields, ShortForm form) noexcept {
  const int bytes = form.near ? 2 : 3;
  out.put(fields.number, 1);
  put_time(out, bytes, fields.sent_ns);
  out.put(fields.echo_number, 1);
  put_time(out, bytes, fields.echo_sent_ns);
  for (std::size_t i = 0; i < 3; ++i) out.put(static_cast<std::uint32_t>(fields.anchor[i]), bytes);
  for (std::size_t i = 3; i < 6; ++i) out.put(static_cast<std::uint32_t>(fields.anchor[i]), 2);
}
void get_short_common(ByteReader& in, const CommonFields& before, ShortForm form, std::int64_t block_ns,
                      CommonFields& fields) noexcept {
  const int bytes = form.near ? 2 : 3;
  fields.number = static_cast<std::uint32_t>(get_near(in, 1, before.number));
  const std::int64_t passed_us = lasting_us(fields.number - before.number, block_ns);
  fields.sent_ns = get_time(in, bytes, later(before.sent_ns, passed_us));
  fields.echo_number = static_cast<std::uint32_t>(get_near(in, 1, before.echo_number));
  // The other stream's blocks mostly take as long.
  const std::int64_t echo_passed_us = lasting_us(fields.echo_number - before.echo_number, block_ns);
  fields.echo_sent_ns = get_time(in, bytes, later(before.echo_sent_ns, echo_passed_us));
  for (std::size_t i = 0; i < 3; ++i) {
    // 2^-16 m/s for so many us, in 2^-24 m.
    const std::int64_t going = std::int64_t{before.anchor[i + 3]} * 256 * passed_us / 1'000'000;
    const auto around = static_cast<std::uint64_t>(before.anchor[i] + going);
    fields.anchor[i] = form.near ? static_cast<std::int32_t>(get_near(in, bytes, around))
                                 : static_cast<std::int32_t>(in.get_signed(bytes));
  }
  for (std::size_t i = 3; i < 6; ++i) fields.anchor[i] = static_cast<std::int32_t>(in.get_signed(2));
}

std::uint16_t age_of(double age_s) noexcept {
  if (!(age_s >= 0.0)) return kNoAge;
  return static_cast<std::uint16_t>(std::min(std::round(age_s * kAgesPerSecond), kNoAge - 1.0));
}

}  // namespace

bool put_set(ByteWriter& out, const CommandBlock& block, std::uint16_t contract) noexcept {
  put_common(out, block, contract);
  out.put(static_cast<std::uint64_t>(block.law), 1);
  out.put(static_cast<std::uint64_t>(block.engaged_before << 1U | (block.engaged ? 1U : 0U)), 1);
  return out.good();
}
std::optional<SetFrame> get_set(ByteReader& in, CommandBlock& block) noexcept {
  const SetFrame set = get_common(in, block);
  const auto law = in.get(1);
  const auto engaged = in.get(1);
  if (!in.good() || law > static_cast<std::uint64_t>(Law::kRemoteAcceleration) || !std::isfinite(block.beta))
    return std::nullopt;
  block.law = static_cast<Law>(law);
  block.engaged = (engaged & 1U) != 0;
  block.engaged_before = static_cast<std::uint8_t>(engaged >> 1U);
  return set;
}

bool put_set(ByteWriter& out, const StateBlock& block, std::uint16_t contract) noexcept {
  put_common(out, block, contract);
  put(out, prefix_of(block.force, block.sequence));
  out.put(block.master_epoch, 4);
  out.put(block.stop_tick, 8);
  out.put(block.guards, 4);
  out.put(static_cast<std::uint64_t>(block.interlock), 1);
  out.put(block.laser_on ? 1 : 0, 1);
  out.put(static_cast<std::uint64_t>(block.mode), 1);
  out.put(static_cast<std::uint64_t>(block.reason), 1);
  return out.good();
}
std::optional<SetFrame> get_set(ByteReader& in, StateBlock& block) noexcept {
  SetFrame set = get_common(in, block);
  set.force = get_prefix(in);
  block.master_epoch = static_cast<std::uint32_t>(in.get(4));
  block.stop_tick = in.get(8);
  block.guards = static_cast<std::uint32_t>(in.get(4));
  const auto interlock = in.get(1);
  block.laser_on = in.get(1) != 0;
  const auto mode = in.get(1);
  const auto reason = in.get(1);
  if (!in.good() || !std::isfinite(block.beta) || interlock > static_cast<std::uint64_t>(kLastInterlock) ||
      mode > static_cast<std::uint64_t>(SlaveMode::kStopped) ||
      reason > static_cast<std::uint64_t>(HoldReason::kStopped))
    return std::nullopt;
  block.interlock = static_cast<Interlock>(interlock);
  block.mode = static_cast<SlaveMode>(mode);
  block.reason = static_cast<HoldReason>(reason);
  return set;
}

std::optional<CommandFields> fields_of(const CommandBlock& block) noexcept {
  CommandFields fields;
  return common_of(block, fields) ? std::optional(fields) : std::nullopt;
}
std::optional<StateFields> fields_of(const StateBlock& block) noexcept {
  StateFields fields;
  if (!common_of(block, fields)) return std::nullopt;
  fields.applied_tick = block.applied_tick;
  fields.applied_bitmap = block.applied_bitmap;
  fields.applied_age_ticks = block.applied_age_ticks;
  fields.playout_ticks = block.playout_ticks;
  fields.echo_received_ns = block.echo_received_ns;
  fields.command_age = age_of(block.command_age_s);
  const bool begins = block.payload.size >= kPayloadPrefixBytes;
  fields.payload_bytes = static_cast<std::uint16_t>(block.payload.size - (begins ? kPayloadPrefixBytes : 0));
  return fields;
}

void apply(const CommandFields& fields, const SetFrame& set, CommandBlock& block) noexcept {
  apply_common(fields, set, block);
}
void apply(const StateFields& fields, const SetFrame& set, StateBlock& block) noexcept {
  apply_common(fields, set, block);
  block.applied_tick = fields.applied_tick;
  block.applied_bitmap = fields.applied_bitmap;
  block.applied_age_ticks = fields.applied_age_ticks;
  block.playout_ticks = fields.playout_ticks;
  block.echo_received_ns = fields.echo_received_ns;
  block.command_age_s = fields.command_age == kNoAge ? -1.0 : fields.command_age / kAgesPerSecond;
}

void put_full(ByteWriter& out, const CommandFields& fields) noexcept { put_full_common(out, fields); }
void put_full(ByteWriter& out, const StateFields& fields) noexcept {
  put_full_common(out, fields);
  out.put(fields.applied_tick, 8);
  out.put(fields.applied_bitmap, 8);
  out.put(fields.applied_age_ticks, 4);
  out.put(static_cast<std::uint32_t>(fields.playout_ticks), 4);
  out.put(static_cast<std::uint64_t>(fields.echo_received_ns), 8);
  out.put(fields.command_age, 2);
  out.put(fields.payload_bytes, 2);
}
void get_full(ByteReader& in, CommandFields& fields) noexcept { get_full_common(in, fields); }
void get_full(ByteReader& in, StateFields& fields) noexcept {
  get_full_common(in, fields);
  fields.applied_tick = in.get(8);
  fields.applied_bitmap = in.get(8);
  fields.applied_age_ticks = static_cast<std::uint32_t>(in.get(4));
  fields.playout_ticks = static_cast<std::int32_t>(in.get_signed(4));
  fields.echo_received_ns = in.get_signed(8);
  fields.command_age = static_cast<std::uint16_t>(in.get(2));
  fields.payload_bytes = static_cast<std::uint16_t>(in.get(2));
}

void put_short(ByteWriter& out, const CommandFields& fields, ShortForm form) noexcept {
  put_short_common(out, fields, form);
}
void put_short(ByteWriter& out, const StateFields& fields, ShortForm form) noexcept {
  put_short_common(out, fields, form);
  out.put(fields.applied_tick, 2);
  if (!form.all_applied) out.put(fields.applied_bitmap, 8);
  out.put(fields.applied_age_ticks, 1);
  out.put(static_cast<std::uint32_t>(fields.playout_ticks), 1);
  // Since it came, us.
  out.put(static_cast<std::uint64_t>(less(fields.sent_ns, fields.echo_received_ns) / kMicrosecond_ns), 2);
  out.put(fields.command_age, 2);
  out.put(fields.payload_bytes, 1);
}
void get_short(ByteReader& in, const CommandFields& before, ShortForm form, std::int64_t block_ns,
               CommandFields& fields) noexcept {
  get_short_common(in, before, form, block_ns, fields);
}
void get_short(ByteReader& in, const StateFields& before, ShortForm form, std::int64_t block_ns,
               StateFields& fields) noexcept {
  get_short_common(in, before, form, block_ns, fields);
  fields.applied_tick = get_near(in, 2, before.applied_tick);
  fields.applied_bitmap = form.all_applied ? ~std::uint64_t{0} : in.get(8);
  fields.applied_age_ticks = static_cast<std::uint32_t>(in.get(1));
  fields.playout_ticks = static_cast<std::int32_t>(in.get(1));
  fields.echo_received_ns = less(fields.sent_ns, kMicrosecond_ns * static_cast<std::int64_t>(in.get(2)));
  fields.command_age = static_cast<std::uint16_t>(in.get(2));
  fields.payload_bytes = static_cast<std::uint16_t>(in.get(1));
}

}  // namespace telekerf
