// SPDX-License-Identifier: Apache-2.0
// What recording costs: a loop of 1 kHz that computes for a while and stores a row of 36 columns, with the
// recorder beside it and without it, in turns within one run. The recorder's share is its thread's own
// processor time, as the kernel counts it: the difference of the two loops is lost in what else a machine
// does. Usage: bench_recording [ROUNDS [SECONDS]]
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/recording/recording.h"
#include "common/runtime/clock.h"
#include "tests/bench/measures.h"

namespace telekerf {
namespace {

using bench::processor_s;
using bench::quantile;

constexpr std::size_t kColumns = 36;
constexpr std::int64_t kPeriod_ns = 1'000'000, kWork_ns = 200'000;

struct Turn {
  double processor = 0.0;        ///< of the whole process, share of one
  double recorder = 0.0;         ///< of the recorder's thread, share of one
  std::vector<double> slack_us;  ///< of each step: what was left of its period
  std::uint64_t overruns = 0, dropped = 0, rows = 0;
};

/// Processor time of the thread of this name so far, s; 0: there is none.
double thread_s(const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string comm;
    double on_processor_ns = 0.0;
    std::getline(std::ifstream(task.path() / "comm"), comm);
    if (comm == name && std::ifstream(task.path() / "schedstat") >> on_processor_ns)
      return 1e-9 * on_processor_ns;
  }
  return 0.0;
}

std::unique_ptr<Recording> recorder(const std::filesystem::path& folder) {
  SeriesSchema schema{.name = "master", .columns = {}, .every_tick = true};
  for (std::size_t i = 0; i < kColumns; ++i)
    schema.columns.push_back({fmt::format("value_{}", i), "", "", ""});
  RunIdentity identity{.role = "master", .program = "bench_recording"};
  date_now(identity);
  return std::make_unique<Recording>(folder / "master.h5", identity,
                                     std::vector<Recording::Part>{{schema, 1000.0}},
                                     [](const std::string& said) { fmt::print("{}\n", said); });
}

Turn turn(const std::filesystem::path& folder, double seconds, bool recorded) {
  Turn result;
  const auto recording = recorded ? recorder(folder) : nullptr;
  const auto steps = static_cast<std::size_t>(seconds * 1e9 / static_cast<double>(kPeriod_ns));
  result.slack_us.reserve(steps);
  std::array<double, kColumns> row{};
  const double before_s = processor_s(), thread_before_s = thread_s("recorder");
  const std::int64_t begin_ns = monotonic_ns();
  std::int64_t due_ns = begin_ns;
  for (std::size_t n = 0; n < steps; ++n) {
    const std::int64_t wait_ns = due_ns - monotonic_ns();
    if (wait_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait_ns));
    for (const std::int64_t until_ns = monotonic_ns() + kWork_ns; monotonic_ns() < until_ns;) ++row[1];
    row[0] = static_cast<double>(n);
    if (recording) recording->ring(0).push(row);
    const std::int64_t left_ns = due_ns + kPeriod_ns - monotonic_ns();
    result.slack_us.push_back(1e-3 * static_cast<double>(left_ns));
    if (left_ns < 0) ++result.overruns;
    due_ns = left_ns < 0 ? monotonic_ns() : due_ns + kPeriod_ns;
  }
  const double took_s = 1e-9 * static_cast<double>(monotonic_ns() - begin_ns);
  result.processor = (processor_s() - before_s) / took_s;
  result.recorder = (thread_s("recorder") - thread_before_s) / took_s;
  if (recording) {
    (void)recording->close({});
    result.dropped = recording->dropped();
    result.rows = recording->acknowledged();
  }
  return result;
}

int run(int rounds, double seconds) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("telekerf-bench-{}", ::getpid());
  std::filesystem::create_directories(folder);
  std::array<Turn, 2> sum;
  std::array<std::vector<double>, 2> shares;
  std::vector<double> recorders;
  for (int round = 0; round < rounds; ++round) {
    for (const bool recorded : {false, true}) {
      const Turn one = turn(folder, seconds, recorded);
      Turn& all = sum[recorded];
      shares[recorded].push_back(one.processor);
      if (recorded) recorders.push_back(one.recorder);
      all.slack_us.insert(all.slack_us.end(), one.slack_us.begin(), one.slack_us.end());
      all.overruns += one.overruns;
      all.dropped += one.dropped;
      all.rows += one.rows;
    }
  }
  std::filesystem::remove_all(folder);
  fmt::print("{} turns of {:g} s each, {} columns at 1 kHz\n", rounds, seconds, kColumns);
  fmt::print("{:<10}{:>12}{:>22}{:>22}{:>10}{:>10}\n", "", "core %", "99 % have slack, us",
             "median slack, us", "overruns", "dropped");
  for (const std::size_t recorded : {0u, 1u})
    fmt::print("{:<10}{:>12.2f}{:>22.1f}{:>22.1f}{:>10}{:>10}\n", recorded ? "recorded" : "plain",
               100 * quantile(shares[recorded], 0.5), quantile(sum[recorded].slack_us, 0.01),
               quantile(sum[recorded].slack_us, 0.5), sum[recorded].overruns, sum[recorded].dropped);
  fmt::print(
      "the recorder takes {:.2f} % of a core (worst turn {:.2f}); slack of 99 % of the steps: {:.3f} of that "
      "without it\n",
      100 * quantile(recorders, 0.5), 100 * quantile(recorders, 1.0),
      quantile(sum[1].slack_us, 0.01) / quantile(sum[0].slack_us, 0.01));
  return 0;
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 4;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 5.0;
  return telekerf::run(std::max(1, rounds), std::max(0.1, seconds));
}
