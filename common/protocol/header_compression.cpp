// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/header_compression.h"

#include <algorithm>
#include <boost/crc.hpp>

namespace telekerf {
namespace {

// The octet after the checksum: the set's tag, and
constexpr std::uint8_t kTagBits = 0x0f;
constexpr std::uint8_t kNear = 0x10;
constexpr std::uint8_t kFull = 0x20;
constexpr std::uint8_t kHasSet = 0x40;
constexpr std::uint8_t kAllApplied = 0x80;

constexpr std::size_t kChecksum = 4;
constexpr std::size_t kMaxFieldBytes = 96;

const Payload* force_of(const CommandBlock& /*block*/) noexcept { return nullptr; }
const Payload* force_of(const StateBlock& block) noexcept { return &block.force; }

/// Whether a block carries its set: at first and after a change some in a row and then now and then, and
/// always after as many samples.
bool carries_set(std::uint32_t number, int samples, int since_change, int repeats) noexcept {
  if (since_change < repeats) return true;
  if (since_change <= 6 * repeats && since_change % 8 == 0) return true;
  return number % static_cast<std::uint32_t>(samples == 0 ? 32 : std::max(1, kSetEverySamples / samples)) ==
         0;
}

/// Of everything that the receiver is to have: the set, the fields in whole, the payloads.
template <class Block, class Fields>
std::uint32_t checksum_of(std::span<const std::uint8_t> set, const Fields& fields,
                          const Block& block) noexcept {
  std::array<std::uint8_t, kMaxFieldBytes> room;
  ByteWriter whole(room);
  put_full(whole, fields);
  boost::crc_32_type crc;
  const auto add = [&crc](std::span<const std::uint8_t> bytes) {
    crc.process_bytes(bytes.data(), bytes.size());
  };
  add(set);
  add(whole.written());
  add(block.payload.view());
  if (const Payload* const force = force_of(block)) add(force->view());
  return crc.checksum();
}

std::span<const std::uint8_t> behind_prefix(const Payload& payload) noexcept {
  const auto all = payload.view();
  return all.size() < kPayloadPrefixBytes ? all : all.subspan(kPayloadPrefixBytes);
}

/// `rest` with what the set says of the payload before it. False: there is no room.
bool join(const PayloadPrefix& prefix, std::uint32_t number, std::span<const std::uint8_t> rest,
          Payload& payload) noexcept {
  const std::size_t size = rest.size() + (prefix.present ? kPayloadPrefixBytes : 0);
  if (size > Payload::kCapacity) return false;
  auto at = payload.bytes.begin();
  if (prefix.present) {
    const auto sequence = static_cast<std::uint16_t>(number + prefix.offset);
    at = std::copy(prefix.format.begin(), prefix.format.end(), at);
    *at++ = static_cast<std::uint8_t>(sequence >> 8);
    *at++ = static_cast<std::uint8_t>(sequence);
  }
  std::copy(rest.begin(), rest.end(), at);
  payload.size = static_cast<std::uint16_t>(size);
  return true;
}

bool get_payloads(ByteReader& in, const CommandFields& fields, const SetFrame& set,
                  CommandBlock& block) noexcept {
  return join(set.payload, fields.number, in.rest(), block.payload);
}
bool get_payloads(ByteReader& in, const StateFields& fields, const SetFrame& set,
                  StateBlock& block) noexcept {
  const auto positions = in.take(fields.payload_bytes);
  return in.good() && join(set.payload, fields.number, positions, block.payload) &&
         join(set.force, fields.number, in.rest(), block.force);
}

}  // namespace

std::optional<std::uint16_t> contract_of_block(std::span<const std::uint8_t> bytes) noexcept {
  ByteReader in(bytes);
  (void)in.get(kChecksum);
  const bool has_set = (in.get(1) & kHasSet) != 0;
  const auto contract = static_cast<std::uint16_t>(in.get(2));
  return has_set && in.good() ? std::optional(contract) : std::nullopt;
}

template <class Block>
bool HeaderCompressor<Block>::restorable(std::span<const std::uint8_t> told, const Fields& fields,
                                         ShortForm form, std::int64_t block_ns) const noexcept {
  for (std::size_t i = 0; i < std::min(count_, kWindow); ++i) {
    ByteReader in(told);
    Fields restored;
    get_short(in, sent_[i], form, block_ns, restored);
    if (!(restored == fields)) return false;
  }
  return true;
}

template <class Block>
std::span<const std::uint8_t> HeaderCompressor<Block>::compress(const Block& block, std::uint16_t contract,
                                                                std::span<std::uint8_t> out) noexcept {
  const Payload* const force = force_of(block);
  const auto fields = fields_of(block);
  if (!fields || block.payload.size > Payload::kCapacity ||
      (force != nullptr && force->size > Payload::kCapacity))
    return {};
  std::array<std::uint8_t, kMaxSetBytes> room{};
  ByteWriter set(room);
  if (!put_set(set, block, contract)) return {};
  if (!std::equal(set.written().begin(), set.written().end(), set_.begin(),
                  set_.begin() + static_cast<std::ptrdiff_t>(set_size_))) {
    set_ = room;
    set_size_ = set.written().size();
    tag_ = static_cast<std::uint8_t>((tag_ + 1U) & kTagBits);
    since_change_ = 0;
  }
  Block scratch;
  ByteReader own(set.written());
  const auto frame = get_set(own, scratch);
  const bool with_set =
      carries_set(fields->number, frame ? frame->payload.samples() : 0, since_change_, kSetRepeats<Block>);
  since_change_ = std::min(since_change_ + 1, kSetEverySamples);

  std::array<std::uint8_t, kMaxFieldBytes> told_room;
  std::uint8_t form = tag_;
  std::span<const std::uint8_t> told;
  if (!with_set) {
    for (const bool near : {fields->number % kFarEvery != 0, false}) {
      ByteWriter shorter(told_room);
      const ShortForm wanted_form = wanted(*fields, near);
      put_short(shorter, *fields, wanted_form);
      if (!frame || !restorable(shorter.written(), *fields, wanted_form, frame->block_ns)) continue;
      told = shorter.written();
      form =
          static_cast<std::uint8_t>(form | (near ? kNear : 0) | (wanted_form.all_applied ? kAllApplied : 0));
      break;
    }
  }
  if (told.empty()) {
    ByteWriter full(told_room);
    put_full(full, *fields);
    told = full.written();
    form = static_cast<std::uint8_t>(form | kFull | (with_set ? kHasSet : 0));
  }
  sent_[count_++ % kWindow] = *fields;

  ByteWriter sample(out);
  sample.put(checksum_of(set.written(), *fields, block), kChecksum);
  sample.put(form, 1);
  if (with_set) sample.put(set.written());
  sample.put(told);
  sample.put(behind_prefix(block.payload));
  if (force != nullptr) sample.put(behind_prefix(*force));
  return sample.good() ? sample.written() : std::span<const std::uint8_t>{};
}

template <class Block>
typename HeaderDecompressor<Block>::Sender* HeaderDecompressor<Block>::find(const SenderKey& key) noexcept {
  for (Sender& sender : senders_) {
    if (sender.heard != 0 && sender.key == key) return &sender;
  }
  return nullptr;
}

template <class Block>
typename HeaderDecompressor<Block>::Sender& HeaderDecompressor<Block>::add(const SenderKey& key) noexcept {
  Sender& longest_silent = *std::min_element(
      senders_.begin(), senders_.end(), [](const Sender& a, const Sender& b) { return a.heard < b.heard; });
  longest_silent = Sender{};
  longest_silent.key = key;
  return longest_silent;
}

template <class Block>
Verdict HeaderDecompressor<Block>::restore(std::span<const std::uint8_t> bytes, const SenderKey& key,
                                           std::uint16_t contract, Block& block) noexcept {
  ByteReader in(bytes);
  const auto checksum = static_cast<std::uint32_t>(in.get(kChecksum));
  const auto form = static_cast<std::uint8_t>(in.get(1));
  if (!in.good()) return Verdict::kDamaged;
  const bool has_set = (form & kHasSet) != 0;
  const std::size_t tag = form & kTagBits;
  Sender* sender = find(key);
  if (!has_set && (sender == nullptr || sender->sets[tag].size == 0)) return Verdict::kUnknownSet;

  std::span<const std::uint8_t> set = in.rest();
  if (!has_set) set = std::span<const std::uint8_t>(sender->sets[tag].bytes).first(sender->sets[tag].size);
  ByteReader set_reader(set);
  const auto frame = get_set(set_reader, block);
  if (!frame) return Verdict::kDamaged;
  set = set.first(set.size() - set_reader.rest().size());
  if (has_set) (void)in.take(set.size());

  Fields fields;
  if ((form & kFull) != 0) {
    get_full(in, fields);
  } else {
    if (sender == nullptr) return Verdict::kUnknownSet;
    get_short(in, sender->newest, {(form & kNear) != 0, (form & kAllApplied) != 0}, frame->block_ns, fields);
  }
  if (!in.good() || !get_payloads(in, fields, *frame, block)) return Verdict::kDamaged;
  apply(fields, *frame, block);
  if (checksum != checksum_of(set, fields, block)) return Verdict::kDamaged;
  if (frame->contract != contract) return Verdict::kForeignContract;

  const bool first = sender == nullptr;
  if (first) sender = &add(key);
  sender->heard = ++turn_;
  if (has_set) {
    std::copy(set.begin(), set.end(), sender->sets[tag].bytes.begin());
    sender->sets[tag].size = set.size();
  }
  const auto ahead = static_cast<std::int32_t>(fields.number - sender->newest.number);
  constexpr std::int32_t kBeganAnew = -128;  // the lowest byte of a number tells no more
  if (first || ahead > 0 || ahead < kBeganAnew) sender->newest = fields;
  return Verdict::kGood;
}

template class HeaderCompressor<CommandBlock>;
template class HeaderCompressor<StateBlock>;
template class HeaderDecompressor<CommandBlock>;
template class HeaderDecompressor<StateBlock>;

}  // namespace telekerf
