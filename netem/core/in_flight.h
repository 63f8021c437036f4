// SPDX-License-Identifier: Apache-2.0
// Packets under way, ordered by due time: fixed storage, O(1) while they come in order, a heap for those that
// don't.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace telekerf::netem {

/// Bounds of what one emulator may hold at once.
struct Capacity {
  std::uint32_t packets = 4096;
  std::uint32_t bytes = 4U << 20;
  std::uint32_t largest_packet = 65536;
};

/// A packet that has arrived. `bytes` stay valid until the emulator's next push or pop; they are empty if the
/// packet was pushed as a size only.
struct Delivery {
  std::uint64_t tag = 0;
  std::span<const std::byte> bytes;
  std::uint32_t size = 0;
  std::int64_t in_ns = 0;
  std::int64_t due_ns = 0;
  bool corrupted = false;
  bool duplicate = false;
};

class InFlight {
 public:
  static constexpr std::uint32_t kMaxPackets = (1U << 24) - 1;

  struct Packet {
    std::int64_t in_ns = 0;
    std::uint64_t tag = 0;
    std::uint32_t size = 0;
    bool corrupted = false;
    bool duplicate = false;
    std::uint64_t queue_place = 0;  ///< whatever reschedule() tells packets by
  };

  explicit InFlight(Capacity capacity);

  bool empty() const noexcept { return run_size_ == 0 && heap_.empty(); }
  std::int64_t next_due() const noexcept {
    return next_from_run() ? run_[run_begin_].due_ns : heap_.front().due_ns;
  }

  /// False, and nothing kept, if there is no room. `bytes` may be empty: then nothing is stored but the
  /// numbers. `flip_bit` < 0: none.
  bool insert(std::int64_t due_ns, const Packet& packet, std::span<const std::byte> bytes,
              std::int64_t flip_bit) noexcept;

  /// Precondition: not empty. Bytes stay valid until the next insert or take.
  void take(Delivery& delivery) noexcept;

  /// due = later(due, queue_place) for every packet, asked in the order of their due times; what it moves
  /// stays behind what was due before it. The latest due time; none: nothing is under way.
  template <typename Later>
  std::optional<std::int64_t> reschedule(Later later) noexcept {
    gather();
    std::optional<std::int64_t> latest_ns;
    for (Key& key : heap_) {
      const std::int64_t due_ns = later(key.due_ns, slots_[key.slot()].queue_place);
      if (due_ns != key.due_ns) key.due_ns = std::max(due_ns, latest_ns.value_or(due_ns));
      latest_ns = std::max(key.due_ns, latest_ns.value_or(key.due_ns));
    }
    sort_heap();
    return latest_ns;
  }

  std::size_t memory_bytes() const noexcept;

 private:
  /// Equal due times leave in the order they came. Compared as one 128-bit number, without a branch: in a
  /// heap no processor could guess it.
  struct Key {
    std::int64_t due_ns;
    std::uint64_t sequence_and_slot;  ///< 40 bits, 24 bits
    bool before(const Key& other) const noexcept {
      using Wide = __int128;
      const Wide mine = static_cast<Wide>(due_ns) << 64 | sequence_and_slot;
      return mine < (static_cast<Wide>(other.due_ns) << 64 | other.sequence_and_slot);
    }
    std::uint32_t slot() const noexcept { return sequence_and_slot & kMaxPackets; }
  };
  struct Slot {
    std::int64_t in_ns;
    std::uint64_t tag;
    std::uint64_t queue_place;
    std::uint32_t first_chunk;  // also links free slots
    std::uint32_t size : 30;
    std::uint32_t corrupted : 1;
    std::uint32_t duplicate : 1;
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  static constexpr std::uint32_t kChunk_bytes = 512;

  bool next_from_run() const noexcept {
    return run_size_ != 0 && (heap_.empty() || run_[run_begin_].before(heap_.front()));
  }
  std::size_t lesser(std::size_t a, std::size_t b) const noexcept {
    const std::size_t choose_b = -static_cast<std::size_t>(heap_[b].before(heap_[a]));
    return a ^ ((a ^ b) & choose_b);
  }
  /// All keys into the heap, by due time.
  void gather() noexcept;
  void sort_heap() noexcept;
  void push_heap(Key key) noexcept;
  void sift_up(std::size_t at, Key key) noexcept;
  Key pop_heap() noexcept;
  std::uint32_t store(std::span<const std::byte> bytes, std::int64_t flip_bit) noexcept;
  std::span<const std::byte> load(std::uint32_t chunk, std::size_t size) noexcept;

  std::vector<Key> run_;  // a ring of those that came in order of their due time
  std::size_t run_begin_ = 0, run_size_ = 0;
  std::int64_t run_last_due_ns_ = 0;
  std::vector<Key> heap_;  // four children a node: half the levels of a binary heap
  std::vector<Slot> slots_;
  std::uint32_t free_slot_ = 0;
  std::uint32_t free_slots_;
  std::vector<std::byte> chunks_;
  std::vector<std::uint32_t> next_chunk_;
  std::uint32_t free_chunk_ = 0;
  std::uint32_t free_chunks_;
  std::vector<std::byte> joined_;  // a packet of several chunks, on its way out
  std::uint64_t sequence_ = 0;
};

}  // namespace telekerf::netem
