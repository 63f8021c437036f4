// SPDX-License-Identifier: Apache-2.0
// Typed writers. The quality of service follows from the type (topics.h).
#pragma once

#include <chrono>
#include <memory>

#include "common/bus/bus.h"
#include "common/protocol/messages.h"

namespace telekerf {

template <class T>
class Writer {
 public:
  explicit Writer(Bus& bus);
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  /// Sends from the calling thread (the contour: from a thread of the middleware). Blocks and telemetry never
  /// wait for anybody; blocks allocate nothing. False: the value breaks a bound of the contract, or the
  /// middleware refused.
  bool write(const T& value) noexcept;
  /// Readers that are matched now.
  int readers() const noexcept;
  /// What is written before a reader is matched is lost for it, unless latched. The reader's side may learn
  /// of the match a little later than this side: blocks may still be lost in between, events are not.
  [[nodiscard]] bool wait_for_reader(std::chrono::nanoseconds timeout, int count = 1) const;
  /// Until every reliable reader has said that it has what was written.
  [[nodiscard]] bool wait_until_received(std::chrono::nanoseconds timeout) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

extern template class Writer<CommandBlock>;
extern template class Writer<StateBlock>;
extern template class Writer<ContourMessage>;
extern template class Writer<EventMessage>;
extern template class Writer<StopMessage>;
extern template class Writer<PreviewMessage>;
extern template class Writer<TelemetryMessage>;

}  // namespace telekerf
