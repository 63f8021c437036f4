// SPDX-License-Identifier: Apache-2.0
// The rows of a run, kept in memory that is taken beside the control loop.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace telekerf {

/// Room for the first rows is taken before the loop starts. Further room is taken by make_room(), where
/// another thread calls it; rows that find none are counted only.
template <typename Row>
class Recorder {
 public:
  explicit Recorder(std::size_t capacity) : first_(std::make_unique<Chunk>(capacity)), last_(first_.get()) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  /// Neither side may be at work any more.
  ~Recorder() { delete spare_.load(); }

  /// Loop only; wait-free, no allocation.
  void push(const Row& row) noexcept {
    if (last_->rows.size() == last_->rows.capacity()) {
      Chunk* const next = spare_.exchange(nullptr, std::memory_order_acq_rel);
      if (next == nullptr) {
        ++dropped_;
        return;
      }
      last_->next.reset(next);
      last_ = next;
    }
    last_->rows.push_back(row);
  }
  /// One other thread only, oftener than a chunk fills: sees to it that there is room for `rows` more.
  void make_room(std::size_t rows) {
    if (spare_.load(std::memory_order_acquire) == nullptr)
      spare_.store(new Chunk(rows), std::memory_order_release);
  }

  /// After the loop, in order.
  std::vector<Row> rows() const {
    std::vector<Row> all;
    for (const Chunk* chunk = first_.get(); chunk != nullptr; chunk = chunk->next.get())
      all.insert(all.end(), chunk->rows.begin(), chunk->rows.end());
    return all;
  }
  std::uint64_t dropped() const { return dropped_; }

 private:
  struct Chunk {
    explicit Chunk(std::size_t capacity) { rows.reserve(capacity); }
    std::vector<Row> rows;
    std::unique_ptr<Chunk> next;
  };
  std::unique_ptr<Chunk> first_;
  Chunk* last_;
  std::atomic<Chunk*> spare_{nullptr};
  std::uint64_t dropped_ = 0;
};

}  // namespace telekerf
