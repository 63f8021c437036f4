// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/result_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <system_error>
#include <thread>

#include "common/runtime/loop.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/parallel.h"
#include "telekerf_commit.h"

extern char** environ;

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// How a process ended: its exit code, 2 if it did not end by itself.
struct Ending {
  int code = 2;
  std::string complaint;  ///< what it said last, or what ended it; only where it could not do its work
};

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

/// Waits for it. Once a stop is requested it is ended, and after two seconds it has no choice.
int status_of(pid_t child) {
  constexpr auto kLook = std::chrono::milliseconds(10);
  constexpr auto kPatience = std::chrono::seconds(2);
  std::optional<Clock::time_point> asked;
  int status = 0;
  for (pid_t ended = 0; ended != child; ended = waitpid(child, &status, WNOHANG)) {
    if (ended < 0 && errno != EINTR) return -1;
    if (stop_requested() && !asked) {
      kill(child, SIGTERM);
      asked = Clock::now();
    } else if (asked && Clock::now() - *asked > kPatience) {
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(kLook);
  }
  // Who interrupts at a terminal interrupts the experiments as well: this process may hear of it after them.
  if (WIFSIGNALED(status) && !stop_requested()) std::this_thread::sleep_for(10 * kLook);
  return status;
}

/// Runs this program with the words; what it says goes to a file.
Ending run_process(std::vector<std::string> words, const fs::path& log) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  words.insert(words.begin(), fs::read_symlink("/proc/self/exe").string());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  // Not by its name: what is built anew meanwhile is another program.
  const int refused = posix_spawn(&child, "/proc/self/exe", &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (refused != 0) return {.complaint = "does not start: " + std::system_category().message(refused)};
  const int status = status_of(child);
  if (status >= 0 && WIFSIGNALED(status))
    return {.complaint = fmt::format("was ended by signal {}", WTERMSIG(status))};
  Ending out{.code = status >= 0 ? WEXITSTATUS(status) : 2, .complaint = {}};
  if (out.code > 1) out.complaint = last_line(log);
  if (out.code > 1 && out.complaint.empty())
    out.complaint = fmt::format("ended with code {}, and said nothing", out.code);
  return out;
}

/// While this process, or one that it began, works in the folder, no other does.
class FolderOfItsOwn {
 public:
  explicit FolderOfItsOwn(const fs::path& folder) : folder_(open(folder.c_str(), O_RDONLY | O_DIRECTORY)) {
    if (folder_ >= 0 && flock(folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(folder_);
      throw environment_error(
          "--out " + folder.string() +
          ": another run works there, or an experiment that outlived it; wait until it ends, or name "
          "another folder");
    }
  }
  ~FolderOfItsOwn() {
    if (folder_ >= 0) close(folder_);
  }
  FolderOfItsOwn(const FolderOfItsOwn&) = delete;
  FolderOfItsOwn& operator=(const FolderOfItsOwn&) = delete;

 private:
  int folder_;  // the experiments inherit it, and with it the lock
};

/// The mark of a run that came to its end; it is written last.
fs::path mark_of(const fs::path& folder) { return folder / "done.json"; }

/// Size and checksum (FNV-1a) of each file that the experiment left, so that what was damaged since is run
/// again.
ordered_json files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path() == mark_of(folder)) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    std::uint64_t sum = 0xcbf29ce484222325U;
    std::size_t size = 0;
    for (std::istreambuf_iterator<char> at(in), end; at != end; ++at, ++size)
      sum = (sum ^ static_cast<unsigned char>(*at)) * 0x100000001b3U;
    files[fs::relative(entry.path(), folder).generic_string()] = fmt::format("{} {:016x}", size, sum);
  }
  return files;
}

std::optional<int> code_of_before(const fs::path& folder, const std::vector<std::string>& words) {
  std::ifstream in(mark_of(folder));
  const auto mark = ordered_json::parse(in, nullptr, false);
  if (!mark.is_object() || mark.value("arguments", ordered_json()) != ordered_json(words) ||
      mark.value("files", ordered_json()) != files_of(folder))
    return std::nullopt;
  const auto code = mark.find("code");
  return code != mark.end() && code->is_number_integer() ? std::optional(code->get<int>()) : std::nullopt;
}

Finished run_one(const ManifestExperiment& experiment, const StorePlan& plan) {
  Finished out{.name = experiment.name, .folder = folder_of(plan, experiment.name), .complaint = {}};
  std::vector<std::string> words = command_words(experiment, plan.seed, plan.quick);
  if (const auto code = is_a_commit(plan.commit) ? code_of_before(out.folder, words) : std::nullopt) {
    out.code = *code;
    out.resumed = true;
    return out;
  }
  const auto begun = Clock::now();
  std::error_code was_none;
  fs::remove_all(out.folder, was_none);
  make_folder("--out", out.folder);
  const ordered_json arguments = words;
  words.insert(words.end(), {"--out", out.folder.string()});
  const fs::path log = out.folder / "log.txt";
  const Ending ending = run_process(words, log);
  out.code = ending.code;
  out.complaint = ending.complaint;
  out.seconds = std::chrono::duration<double>(Clock::now() - begun).count();
  if (out.code > 1) return out;
  fs::remove(log);                         // all that counts is in the results
  fs::remove(out.folder / "timing.json");  // what depends on the clock is none
  write_json(mark_of(out.folder),
             ordered_json{{"arguments", arguments}, {"code", out.code}, {"files", files_of(out.folder)}});
  return out;
}

/// Shares of the cost that are done, on standard error.
class Progress {
 public:
  Progress(double whole_s, std::size_t count) : whole_s_(whole_s), count_(count) {}
  void add(const Finished& one, double cost_s) {
    const std::lock_guard lock(mutex_);
    done_s_ += cost_s;
    ++done_;
    const double share = done_s_ / whole_s_;
    const auto filled = static_cast<std::size_t>(std::lround(30.0 * share));
    const std::string bar = std::string(filled, '#') + std::string(30 - filled, '.');
    const std::string what = one.resumed    ? "was there"
                             : one.code > 1 ? "could not be run"
                                            : fmt::format("{:.0f} s", one.seconds);
    const bool terminal = isatty(STDERR_FILENO) != 0;
    fmt::print(stderr, "{}[{}] {:3.0f} % {} of {}: {} ({}){}", terminal ? "\r\033[K" : "", bar, 100.0 * share,
               done_, count_, one.name, what, terminal && done_ < count_ ? "" : "\n");
  }

 private:
  std::mutex mutex_;
  double whole_s_, done_s_ = 0.0;
  std::size_t count_, done_ = 0;
};

}  // namespace

std::string built_commit() { return TELEKERF_COMMIT; }

bool is_a_commit(const std::string& commit) { return commit != "unknown" && !commit.ends_with("-changed"); }

fs::path folder_of(const StorePlan& plan, const std::string& experiment) {
  return plan.out / "results" / plan.commit / experiment /
         fmt::format("{}{}", plan.seed, plan.quick ? "-quick" : "");
}

std::vector<Finished> run_experiments(const Manifest& manifest, const StorePlan& plan) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < manifest.experiments.size(); ++i) {
    const std::string& name = manifest.experiments[i].name;
    if (plan.only.empty() || std::find(plan.only.begin(), plan.only.end(), name) != plan.only.end())
      order.push_back(i);
  }
  make_folder("--out", plan.out / "results");
  const FolderOfItsOwn only_here(plan.out);
  // The longest first, so that none is left over at the end.
  const auto cost = [&](std::size_t i) { return manifest.experiments[i].cost_s; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cost(a) > cost(b); });
  Progress progress(std::accumulate(order.begin(), order.end(), 0.0,
                                    [&](double sum, std::size_t i) { return sum + cost(i); }),
                    order.size());
  std::vector<Finished> finished(manifest.experiments.size());
  for_each_parallel(
      order.size(),
      [&](std::size_t n) {
        if (stop_requested()) return;
        const ManifestExperiment& experiment = manifest.experiments[order[n]];
        Finished& out = finished[order[n]];
        try {
          out = run_one(experiment, plan);
        } catch (const std::exception& error) {
          out = {
              .name = experiment.name, .folder = folder_of(plan, experiment.name), .complaint = error.what()};
        }
        if (stop_requested() && out.code > 1) {
          std::error_code was_none;
          fs::remove_all(out.folder, was_none);  // half a run is none
          out.name.clear();
          return;
        }
        progress.add(out, experiment.cost_s);
      },
      plan.jobs);
  std::erase_if(finished, [](const Finished& one) { return one.name.empty(); });
  return finished;
}

ResultsByName read_results(const Manifest& manifest, const std::vector<Finished>& finished) {
  ResultsByName results;
  for (const Finished& one : finished) {
    std::ifstream in(one.folder / manifest.experiment(one.name).result);
    auto json = ordered_json::parse(in, nullptr, false);
    if (one.code <= 1 && !json.is_discarded()) results.emplace(one.name, std::move(json));
  }
  return results;
}

}  // namespace telekerf::experiments
