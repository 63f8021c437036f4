// SPDX-License-Identifier: Apache-2.0
#include "netem/core/in_flight.h"

#include <algorithm>
#include <cstring>

namespace telekerf::netem {

InFlight::InFlight(Capacity capacity)
    : run_(std::min(capacity.packets, kMaxPackets)),
      slots_(run_.size()),
      free_slots_(static_cast<std::uint32_t>(run_.size())),
      chunks_((static_cast<std::size_t>(capacity.bytes) + kChunk_bytes - 1) / kChunk_bytes * kChunk_bytes),
      next_chunk_(chunks_.size() / kChunk_bytes),
      free_chunks_(static_cast<std::uint32_t>(next_chunk_.size())),
      joined_(std::min<std::size_t>(capacity.largest_packet, chunks_.size())) {
  heap_.reserve(run_.size());
  for (std::uint32_t i = 0; i < slots_.size(); ++i) slots_[i].first_chunk = i + 1;
  for (std::uint32_t i = 0; i < next_chunk_.size(); ++i) next_chunk_[i] = i + 1;
}

bool InFlight::insert(std::int64_t due_ns, const Packet& packet, std::span<const std::byte> bytes,
                      std::int64_t flip_bit) noexcept {
  const std::size_t chunks = (bytes.size() + kChunk_bytes - 1) / kChunk_bytes;
  if (free_slots_ == 0 || chunks > free_chunks_ || bytes.size() > joined_.size()) return false;
  const std::uint32_t slot = free_slot_;
  free_slot_ = slots_[slot].first_chunk;
  --free_slots_;
  Slot& kept = slots_[slot];
  kept.in_ns = packet.in_ns;
  kept.tag = packet.tag;
  kept.queue_place = packet.queue_place;
  kept.first_chunk = store(bytes, flip_bit);
  kept.size = packet.size & 0x3FFFFFFF;
  kept.corrupted = packet.corrupted;
  kept.duplicate = packet.duplicate;
  const Key key{due_ns, sequence_++ << 24 | slot};
  if (run_size_ == 0 || due_ns >= run_last_due_ns_) {
    std::size_t end = run_begin_ + run_size_++;
    if (end >= run_.size()) end -= run_.size();
    run_[end] = key;
    run_last_due_ns_ = due_ns;
  } else {
    push_heap(key);
  }
  return true;
}

void InFlight::take(Delivery& delivery) noexcept {
  Key key;
  if (next_from_run()) {
    key = run_[run_begin_];
    if (++run_begin_ == run_.size()) run_begin_ = 0;
    --run_size_;
  } else {
    key = pop_heap();
  }
  Slot& slot = slots_[key.slot()];
  delivery.tag = slot.tag;
  delivery.in_ns = slot.in_ns;
  delivery.due_ns = key.due_ns;
  delivery.size = slot.size;
  delivery.corrupted = slot.corrupted != 0;
  delivery.duplicate = slot.duplicate != 0;
  if (slot.first_chunk != kNone) delivery.bytes = load(slot.first_chunk, slot.size);
  slot.first_chunk = free_slot_;
  free_slot_ = key.slot();
  ++free_slots_;
}

void InFlight::gather() noexcept {
  for (; run_size_ > 0; --run_size_) {
    heap_.push_back(run_[run_begin_]);  // reserved: never more keys than slots
    if (++run_begin_ == run_.size()) run_begin_ = 0;
  }
  sort_heap();
}

/// What is sorted is a heap, whatever the number of children.
void InFlight::sort_heap() noexcept {
  std::sort(heap_.begin(), heap_.end(), [](const Key& a, const Key& b) { return a.before(b); });
}

void InFlight::push_heap(Key key) noexcept {
  heap_.push_back(key);  // reserved in the constructor: never more keys than slots
  sift_up(heap_.size() - 1, key);
}

void InFlight::sift_up(std::size_t at, Key key) noexcept {
  while (at > 0) {
    const std::size_t parent = (at - 1) / 4;
    if (!key.before(heap_[parent])) break;
    heap_[at] = heap_[parent];
    at = parent;
  }
  heap_[at] = key;
}

InFlight::Key InFlight::pop_heap() noexcept {
  const Key top = heap_.front();
  const Key last = heap_.back();
  heap_.pop_back();
  const std::size_t size = heap_.size();
  if (size == 0) return top;
  // The hole sinks to the bottom first; the last key, a late one, then has hardly a step to climb.
  std::size_t at = 0;
  for (;;) {
    const std::size_t first = 4 * at + 1;
    if (first >= size) break;
    std::size_t least = first;
    if (first + 3 < size) {
      least = lesser(lesser(first, first + 1), lesser(first + 2, first + 3));
    } else {
      for (std::size_t child = first + 1; child < size; ++child) least = lesser(least, child);
    }
    heap_[at] = heap_[least];
    at = least;
  }
  sift_up(at, last);
  return top;
}

std::uint32_t InFlight::store(std::span<const std::byte> bytes, std::int64_t flip_bit) noexcept {
  if (bytes.empty()) return kNone;
  const std::uint32_t first = free_chunk_;
  std::uint32_t last = first;
  for (std::size_t offset = 0; offset < bytes.size(); offset += kChunk_bytes) {
    last = free_chunk_;
    free_chunk_ = next_chunk_[last];
    --free_chunks_;
    std::byte* const chunk = chunks_.data() + static_cast<std::size_t>(last) * kChunk_bytes;
    std::memcpy(chunk, bytes.data() + offset, std::min<std::size_t>(kChunk_bytes, bytes.size() - offset));
    const std::int64_t bit = flip_bit - static_cast<std::int64_t>(8 * offset);
    if (flip_bit >= 0 && bit >= 0 && bit < 8 * static_cast<std::int64_t>(kChunk_bytes)) {
      chunk[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
    }
  }
  next_chunk_[last] = kNone;
  return first;
}

std::span<const std::byte> InFlight::load(std::uint32_t chunk, std::size_t size) noexcept {
  const std::byte* const only = chunks_.data() + static_cast<std::size_t>(chunk) * kChunk_bytes;
  const bool single = next_chunk_[chunk] == kNone;
  for (std::size_t offset = 0; chunk != kNone; offset += kChunk_bytes) {
    if (!single) {
      std::memcpy(joined_.data() + offset, chunks_.data() + static_cast<std::size_t>(chunk) * kChunk_bytes,
                  std::min<std::size_t>(kChunk_bytes, size - offset));
    }
    const std::uint32_t next = next_chunk_[chunk];
    next_chunk_[chunk] = free_chunk_;
    free_chunk_ = chunk;
    ++free_chunks_;
    chunk = next;
  }
  return {single ? only : joined_.data(), size};
}

std::size_t InFlight::memory_bytes() const noexcept {
  return run_.capacity() * sizeof(Key) + heap_.capacity() * sizeof(Key) + slots_.capacity() * sizeof(Slot) +
         chunks_.capacity() + next_chunk_.capacity() * sizeof(std::uint32_t) + joined_.capacity();
}

}  // namespace telekerf::netem
