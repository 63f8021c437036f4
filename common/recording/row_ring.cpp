// SPDX-License-Identifier: Apache-2.0
#include "common/recording/row_ring.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

namespace telekerf {
namespace {

/// Null if the file cannot be made, or has not the room: a page that is missing later would end the process.
void* map_file(const std::filesystem::path& file, std::size_t bytes) {
  ::unlink(file.c_str());
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return nullptr;
  void* memory = MAP_FAILED;
  if (::posix_fallocate(fd, 0, static_cast<off_t>(bytes)) == 0)
    memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
  ::close(fd);
  if (memory != MAP_FAILED) return memory;
  ::unlink(file.c_str());
  return nullptr;
}

}  // namespace

RowRing::RowRing(std::size_t columns, std::size_t capacity, const std::filesystem::path& file)
    : file_(file), bytes_(kHeaderBytes + std::max<std::size_t>(capacity, 2) * columns * sizeof(double)) {
  if (!file_.empty()) memory_ = map_file(file_, bytes_);
  if (memory_ == nullptr) {
    file_.clear();
    memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
  }
  header_ = new (memory_) Header;
  header_->columns = columns;
  header_->capacity = std::max<std::size_t>(capacity, 2);
  header_->magic = kMagic;
  slots_ = reinterpret_cast<double*>(static_cast<std::byte*>(memory_) + kHeaderBytes);
}

RowRing::~RowRing() {
  ::munmap(memory_, bytes_);
  if (!file_.empty() && !keep_) ::unlink(file_.c_str());
}

void RowRing::push(std::span<const double> row) noexcept {
  const std::uint64_t head = header_->head.load(std::memory_order_relaxed);
  double* slot = slots_ + (head % header_->capacity) * header_->columns;
  for (const double number : row.first(std::min<std::size_t>(row.size(), columns())))
    std::atomic_ref<double>(*slot++).store(number, std::memory_order_relaxed);
  header_->head.store(head + 1, std::memory_order_release);
}

std::uint64_t RowRing::copy(std::uint64_t from, std::size_t rows, std::vector<double>& out) const {
  const std::size_t width = columns();
  // A reader that is far behind goes on at the oldest row that is there.
  const std::uint64_t pushed = head();
  std::uint64_t first = from;
  if (pushed > capacity()) first = std::max<std::uint64_t>(first, pushed - capacity());
  const std::uint64_t end = std::min<std::uint64_t>(pushed, first + rows);
  const std::size_t before = out.size();
  for (std::uint64_t n = first; n < end; ++n) {
    double* slot = slots_ + (n % header_->capacity) * width;
    for (std::size_t c = 0; c < width; ++c)
      out.push_back(std::atomic_ref<double>(slot[c]).load(std::memory_order_relaxed));
  }
  // What the producer has overwritten meanwhile, or is at, is nothing.
  std::atomic_thread_fence(std::memory_order_acquire);
  const std::uint64_t now = header_->head.load(std::memory_order_relaxed);
  const std::uint64_t oldest = now + 1 > capacity() ? now + 1 - capacity() : 0;
  if (oldest > first) {
    const std::uint64_t gone = std::min(oldest, end) - std::min(first, end);
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(before);
    out.erase(begin, begin + static_cast<std::ptrdiff_t>(gone * width));
    first = std::min(oldest, end);
  }
  return std::max(first, from);
}

void RowRing::acknowledge(std::uint64_t row, std::uint64_t elsewhere) noexcept {
  header_->version.fetch_add(1, std::memory_order_acq_rel);
  header_->acknowledged.store(row, std::memory_order_release);
  header_->elsewhere.store(elsewhere, std::memory_order_release);
  header_->version.fetch_add(1, std::memory_order_acq_rel);
}

std::optional<RowRing::Left> RowRing::read(const std::filesystem::path& file, std::size_t columns) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  struct stat status {};
  const bool there = ::fstat(fd, &status) == 0 && static_cast<std::size_t>(status.st_size) > kHeaderBytes;
  const auto bytes = static_cast<std::size_t>(status.st_size);
  void* const memory = there ? ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0) : MAP_FAILED;
  ::close(fd);
  if (memory == MAP_FAILED) return std::nullopt;
  std::optional<Left> left;
  const auto* header = static_cast<const Header*>(memory);
  const std::uint64_t room = (bytes - kHeaderBytes) / sizeof(double);
  // Killed just between the two: then what stands in the file is believed, and nothing is taken twice.
  if (header->magic == kMagic && header->columns == columns && columns > 0 && header->capacity >= 2 &&
      header->capacity <= room / columns && header->version.load() % 2 == 0) {
    left.emplace();
    left->elsewhere = header->elsewhere.load();
    const std::uint64_t head = header->head.load();
    const std::uint64_t from = std::min(header->acknowledged.load(), head);
    // The oldest slot may have been half overwritten when it ended.
    const std::uint64_t oldest = head + 1 > header->capacity ? head + 1 - header->capacity : 0;
    left->overwritten = oldest > from ? oldest - from : 0;
    const auto* slots = reinterpret_cast<const double*>(static_cast<const std::byte*>(memory) + kHeaderBytes);
    for (std::uint64_t n = oldest; n < head; ++n) {
      const double* slot = slots + (n % header->capacity) * columns;
      left->last.insert(left->last.end(), slot, slot + columns);
      if (n >= from) left->numbers.insert(left->numbers.end(), slot, slot + columns);
    }
  }
  ::munmap(memory, bytes);
  return left;
}

}  // namespace telekerf
