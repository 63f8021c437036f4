// SPDX-License-Identifier: Apache-2.0
// Typed readers. The quality of service follows from the type (topics.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/bus.h"
#include "common/protocol/messages.h"

namespace telekerf {

struct ReaderCounters {
  std::uint64_t received = 0;          ///< good ones
  std::uint64_t damaged = 0;           ///< checksum, broken encoding or bound
  std::uint64_t foreign_contract = 0;  ///< written under another version of the contract
  std::uint64_t unknown_set = 0;       ///< refer to what an earlier block said, which has not come
  std::uint64_t strangers = 0;         ///< of nobody who may say it, see Bus::strangers(); not looked at
  std::uint64_t dropped = 0;           ///< good, but nobody took them and the ring was full
};

template <class T>
class Reader {
 public:
  /// `capacity`: samples that wait to be taken (0: as topics.h says).
  explicit Reader(Bus& bus, std::size_t capacity = 0);
  /// Each good one goes to `tap`, in the middleware's thread and before any queue; take() has none.
  Reader(Bus& bus, std::function<void(const T&)> tap);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  /// The oldest that waits, in order of arrival (which need not be the order of sending, see topics.h); own
  /// samples are never seen. For one thread, without lock; for blocks without allocation: made for the
  /// control loop.
  std::optional<Received<T>> take() noexcept;
  ReaderCounters counters() const noexcept;
  /// Writers that are matched now.
  int writers() const noexcept;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Everything that waits, as far as `out` has room without growing: for the control loop. `Item` is T, or
/// Received<T> where the time of arrival matters.
template <class T, class Item>
void drain(Reader<T>& reader, std::vector<Item>& out) noexcept {
  out.clear();
  while (out.size() < out.capacity()) {
    auto received = reader.take();
    if (!received) return;
    if constexpr (std::is_same_v<Item, T>) {
      out.push_back(std::move(received->value));
    } else {
      out.push_back(std::move(*received));
    }
  }
}

extern template class Reader<CommandBlock>;
extern template class Reader<StateBlock>;
extern template class Reader<ContourMessage>;
extern template class Reader<EventMessage>;
extern template class Reader<StopMessage>;
extern template class Reader<PreviewMessage>;
extern template class Reader<TelemetryMessage>;

}  // namespace telekerf
