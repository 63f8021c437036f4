// SPDX-License-Identifier: Apache-2.0
#include "common/bus/quiet_log.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <mutex>

#include "common/runtime/say.h"

namespace telekerf::bus {
namespace {

namespace dds = eprosima::fastdds::dds;

constexpr int kLines = 3;  // a second

/// Called from the middleware's thread for its log.
class Consumer : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const auto now = std::chrono::steady_clock::now();
    if (now - since_ >= std::chrono::seconds(1)) {
      if (left_out_ > 0) write_line(stderr, fmt::format("middleware: and {} more of the kind", left_out_));
      since_ = now;
      said_ = left_out_ = 0;
    }
    if (said_ == kLines) {
      ++left_out_;
      return;
    }
    ++said_;
    write_line(stderr, fmt::format("middleware: {}: {}", entry.context.category, entry.message));
  }

 private:
  std::chrono::steady_clock::time_point since_{};
  int said_ = 0;
  int left_out_ = 0;
};

}  // namespace

void quiet_log() {
  static std::once_flag once;
  std::call_once(once, [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<Consumer>());
  });
}

}  // namespace telekerf::bus
