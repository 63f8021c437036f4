// SPDX-License-Identifier: Apache-2.0
// The last rows of a table, in memory that outlives the process: the control loop only stores a row.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "common/recording/columns.h"
#include "common/recording/series.h"

namespace telekerf {

/// One producer, one consumer, no lock. The producer never waits: it overwrites the oldest row; the consumer
/// sees what it has missed. Where the ring lies in a file of a memory file system, its rows are there after the
/// process was killed.
class RowRing {
 public:
  /// `file`: made there, replaced if there; if that cannot be, or it is empty, in the process' own memory.
  RowRing(std::size_t columns, std::size_t capacity, const std::filesystem::path& file = {});
  ~RowRing();  ///< removes the file
  RowRing(const RowRing&) = delete;
  RowRing& operator=(const RowRing&) = delete;

  /// Producer only: wait-free, no allocation.
  template <typename Row>
  void push(std::span<const Column<Row>> columns, const Row& row) noexcept {
    const std::uint64_t head = header_->head.load(std::memory_order_relaxed);
    double* slot = slots_ + (head % header_->capacity) * header_->columns;
    for (const Column<Row>& column : columns)
      std::atomic_ref<double>(*slot++).store(column.read(row), std::memory_order_relaxed);
    header_->head.store(head + 1, std::memory_order_release);
  }
  void push(std::span<const double> row) noexcept;

  /// Rows that were ever pushed.
  std::uint64_t head() const noexcept { return header_->head.load(std::memory_order_acquire); }
  std::size_t capacity() const noexcept { return static_cast<std::size_t>(header_->capacity); }
  std::size_t columns() const noexcept { return static_cast<std::size_t>(header_->columns); }
  /// The rows from number `from` on, `rows` at most, appended to `out`; returns the number of the first that is
  /// there, which is greater than `from` where older ones have been overwritten.
  std::uint64_t copy(std::uint64_t from, std::size_t rows, std::vector<double>& out) const;

  /// Consumer: rows before number `row` are safe elsewhere, as the first `elsewhere` rows there.
  void acknowledge(std::uint64_t row, std::uint64_t elsewhere) noexcept;
  /// Where the rows outlive the process; empty: they do not.
  const std::filesystem::path& file() const noexcept { return file_; }
  /// The file stays when this ends.
  void keep() noexcept { keep_ = true; }

  /// What a killed process has left.
  struct Left {
    std::uint64_t elsewhere = 0;  ///< rows of the other place that were acknowledged
    std::vector<double> numbers;  ///< all rows after these, in order
    std::uint64_t overwritten = 0;  ///< rows between the two that nobody has
    std::vector<double> last;       ///< all rows that the memory holds
  };
  /// None: there is no such ring of so many columns.
  static std::optional<Left> read(const std::filesystem::path& file, std::size_t columns);

 private:
  struct Header {
    std::uint64_t magic = 0;
    std::uint64_t columns = 0;
    std::uint64_t capacity = 0;
    std::atomic<std::uint64_t> version{0};  // odd while the two below change
    std::atomic<std::uint64_t> acknowledged{0};
    std::atomic<std::uint64_t> elsewhere{0};
    alignas(64) std::atomic<std::uint64_t> head{0};
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  static constexpr std::uint64_t kMagic = 0x31474e4952464b54;  // "TKFRING1"
  static constexpr std::size_t kHeaderBytes = 4096;

  std::filesystem::path file_;
  bool keep_ = false;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  Header* header_ = nullptr;
  double* slots_ = nullptr;
};

}  // namespace telekerf
