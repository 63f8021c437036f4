// SPDX-License-Identifier: Apache-2.0
#include "master/console/run_shelf.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <charconv>
#include <csignal>
#include <optional>
#include <utility>

extern char** environ;

namespace telekerf::master {
namespace {

using Error = boost::system::error_code;
/// Of all that is being read.
constexpr std::size_t kMostBytes = 512U << 20U;

/// Of a query's value; none: it is no percent encoding.
std::optional<std::string> decoded(std::string_view text) {
  std::string plain;
  for (std::size_t n = 0; n < text.size(); ++n) {
    unsigned code = 0;
    if (text[n] != '%') {
      plain += text[n];
    } else if (n + 2 < text.size() &&
               std::from_chars(&text[n + 1], &text[n + 3], code, 16).ptr == &text[n + 3]) {
      plain += static_cast<char>(code);
      n += 2;
    } else {
      return std::nullopt;
    }
  }
  return plain;
}

std::string value_in(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
    if (part.starts_with(key) && part.size() > key.size() && part[key.size()] == '=')
      return decoded(part.substr(key.size() + 1)).value_or("");
  }
  return {};
}

/// A file descriptor pair for a child's output; the child inherits the end that it writes to.
struct Pipe {
  Pipe() { open = ::pipe2(ends, O_CLOEXEC) == 0; }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take_reader() { return std::exchange(ends[0], -1); }
  int ends[2] = {-1, -1};
  bool open = false;
};

}  // namespace

bool parse_run_question(std::string_view target, RunQuestion& question) {
  question = {};
  const std::string_view path = target.substr(0, target.find('?'));
  if (path == "/runs") return true;
  if (path != "/run") return false;
  const std::string_view query = target.substr(std::min(target.size(), path.size() + 1));
  question.what = value_in(query, "what");
  if (question.what.empty()) question.what = "playback";
  // It becomes a word of a command line: no option is smuggled in.
  if (question.what.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.") != question.what.npos) question.what.clear();
  const std::string name = value_in(query, "name");
  if (!name.starts_with('.') && name.find_first_of(std::string_view("/\0", 2)) == name.npos) question.name = name;
  return true;
}

/// A running telekerf-inspect and what it has said.
struct RunShelf::Reading : std::enable_shared_from_this<RunShelf::Reading> {
  Reading(boost::asio::io_context& context, std::shared_ptr<std::size_t> of_all, Done to)
      : done(std::move(to)), held(std::move(of_all)), timer(context), ending(context), outputs{Output(context), Output(context)} {}
  ~Reading() {
    if (child <= 0) return;
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }

  bool start(const std::vector<std::string>& words, std::chrono::milliseconds patience) {
    std::array<Pipe, 2> pipes;
    if (!pipes[0].open || !pipes[1].open) return false;
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    for (const int n : {0, 1}) posix_spawn_file_actions_adddup2(&files, pipes[n].ends[1], n + 1);
    const int failed = ::posix_spawn(&child, arguments[0], &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0) {
      child = 0;
      return false;
    }
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(child), 10);  // whoever drives comes first
    for (const int n : {0, 1}) {
      outputs[n].stream.assign(pipes[n].take_reader());
      read(outputs[n]);
    }
    timer.expires_after(patience);
    timer.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->give_up({504, "The run cannot be read in reasonable time; is its file damaged?"});
    });
    return true;
  }

  struct Output {
    explicit Output(boost::asio::io_context& context) : stream(context) {}
    boost::asio::posix::stream_descriptor stream;
    std::array<char, 65536> piece;
    std::string all;
    bool ended = false;
  };

  void read(Output& output) {
    output.stream.async_read_some(boost::asio::buffer(output.piece),
                                  [self = shared_from_this(), &output](Error error, std::size_t count) {
                                    self->take(output, error, count);
                                  });
  }
  void take(Output& output, Error error, std::size_t count) {
    if (!done) return;
    output.all.append(output.piece.data(), count);
    had += count;
    *held += count;
    if (*held > kMostBytes) return give_up({404, "This is too much to be sent to a page"});
    if (!error) return read(output);
    output.ended = true;
    if (outputs[0].ended && outputs[1].ended) finish();
  }
  /// Both outputs are closed, so the child is about to end.
  void finish() {
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == 0) {
      ending.expires_after(std::chrono::milliseconds(2));
      ending.async_wait([self = shared_from_this()](Error error) {
        if (!error && self->done) self->finish();
      });
      return;
    }
    child = 0;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return answer({200, std::move(outputs[0].all)});
    answer({404, outputs[1].all.empty() ? "The run cannot be read: its file is damaged" : outputs[1].all});
  }
  void give_up(Answer why) {
    if (child > 0) {
      ::kill(child, SIGKILL);
      ::waitpid(std::exchange(child, 0), nullptr, 0);
    }
    answer(std::move(why));
  }
  void answer(Answer what) {
    timer.cancel();
    Error ignored;
    *held -= had;
    for (Output& output : outputs) output.stream.close(ignored);
    std::exchange(done, nullptr)(std::move(what));
  }

  Done done;
  std::shared_ptr<std::size_t> held;  ///< bytes of all readings,
  std::size_t had = 0;                ///< and of this one
  boost::asio::steady_timer timer, ending;
  std::array<Output, 2> outputs;
  pid_t child = 0;
};

RunShelf::RunShelf(boost::asio::io_context& context, RunShelfSettings settings)
    : context_(context), settings_(std::move(settings)) {}

RunShelf::~RunShelf() {
  for (Waiting& question : std::exchange(waiting_, {})) question.done({503, "The console ends"});
  for (const auto& reading : std::vector(readings_)) reading->give_up({503, "The console ends"});
}

void RunShelf::refuse(int status, const std::string& why, const Done& done) {
  ++(status == 503 ? refused_ : failed_);
  boost::asio::post(context_, [done, answer = Answer{status, why}] { done(answer); });
}

void RunShelf::ask(const RunQuestion& question, Done done) {
  if (question.name.empty() != question.what.empty())
    return refuse(404, "No run has this name, or nothing of it does", done);
  std::vector<std::string> words{settings_.inspect.string()};
  if (question.what.empty())
    words.insert(words.end(), {"runs", settings_.folder.string(), "--json"});
  else
    words.insert(words.end(), {"export", (settings_.folder / question.name).string(), question.what});
  if (readings_.size() < kAtOnce) return read({std::move(words), std::move(done)});
  if (waiting_.size() >= kMostWaiting)
    return refuse(503, "Many others read runs; ask again in a moment", done);
  waiting_.push_back({std::move(words), std::move(done)});
}

void RunShelf::read(Waiting question) {
  const Done done = question.done;
  const auto reading = std::make_shared<Reading>(context_, held_, nullptr);
  reading->done = [this, done, which = reading.get()](Answer answer) {
    ++(answer.status == 200 ? read_ : failed_);
    ended(which);
    done(std::move(answer));
  };
  if (reading->start(question.words, settings_.patience)) return readings_.push_back(reading);
  reading->done = nullptr;
  refuse(404, fmt::format("{} does not start; it reads the runs", settings_.inspect.string()), done);
}

void RunShelf::ended(const Reading* reading) {
  std::erase_if(readings_, [reading](const auto& one) { return one.get() == reading; });
  if (waiting_.empty()) return;
  Waiting next = std::move(waiting_.front());
  waiting_.pop_front();
  read(std::move(next));
}

void RunShelf::add_figures(Metrics& figures) const {
  figures["runs_read"] = static_cast<double>(read_);
  figures["runs_failed"] = static_cast<double>(failed_);
  figures["runs_refused"] = static_cast<double>(refused_);
}

}  // namespace telekerf::master
