// SPDX-License-Identifier: Apache-2.0
// Hands prepared things from a thread that may allocate to a control loop that may not, and takes them back
// to be freed where they were made.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

namespace telekerf {

/// One giver, one loop. At most four of them live: offered, in use, the one used before, and one on its way
/// back. What is offered before the loop has taken the offer before it replaces that.
template <class T>
class Handover {
 public:
  Handover() = default;
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;
  /// Neither side may be at work any more.
  ~Handover() {
    delete offered_.load();
    delete returned_.load();
  }

  /// Giver only. Frees what it replaces, and what the loop has returned.
  void offer(std::unique_ptr<T> thing) {
    delete offered_.exchange(thing.release(), std::memory_order_acq_rel);
    collect();
  }
  /// Giver only: frees what the loop has returned.
  void collect() { delete returned_.exchange(nullptr, std::memory_order_acquire); }

  /// Loop only, once a step; wait-free, no allocation. The newest that was offered, null before the first. It
  /// stays valid through the step in which another one takes its place, so that a step may compare the two.
  T* current() noexcept {
    if (before_) give_back();
    if (!before_ && offered_.load(std::memory_order_relaxed) != nullptr) {
      before_ = std::move(current_);
      current_.reset(offered_.exchange(nullptr, std::memory_order_acq_rel));
    }
    return current_.get();
  }

 private:
  /// The giver may not have collected the last one yet; then a later step tries again, and nothing new is
  /// taken until then.
  void give_back() noexcept {
    T* none = nullptr;
    if (returned_.compare_exchange_strong(none, before_.get(), std::memory_order_release,
                                          std::memory_order_relaxed)) {
      (void)before_.release();
    }
  }

  std::atomic<T*> offered_{nullptr};
  std::atomic<T*> returned_{nullptr};
  std::unique_ptr<T> current_;  // the loop's, as is
  std::unique_ptr<T> before_;   // ... the one used before
};

}  // namespace telekerf
