// SPDX-License-Identifier: Apache-2.0
// Two network namespaces for tests: this process lives in the operator's, a sleeping child holds the slave's.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace telekerf::integration {

enum class Side { kOperator, kSlave };

class Namespaces {
 public:
  /// Made once a process; `obstacle()` says why it could not be done here, or is empty.
  static Namespaces& instance() {
    static Namespaces namespaces;
    return namespaces;
  }
  const std::string& obstacle() const { return obstacle_; }
  std::string slave_path() const { return "/proc/" + std::to_string(holder_) + "/ns/net"; }

  /// Runs a shell command in the slave's namespace.
  bool in_slave(const std::string& command) const {
    return std::system(("nsenter --net=" + slave_path() + " sh -c '" + command + "'").c_str()) == 0;
  }

  /// A child process on one side; it dies with this one.
  pid_t fork_on(Side side, const std::function<void()>& body) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (side == Side::kSlave) {
      const int fd = ::open(slave_path().c_str(), O_RDONLY | O_CLOEXEC);
      if (fd < 0 || ::setns(fd, CLONE_NEWNET) != 0) std::_Exit(126);
    }
    body();
    std::_Exit(127);
  }

 private:
  Namespaces() : obstacle_(make()) {}
  ~Namespaces() {
    if (holder_ > 0) {
      ::kill(holder_, SIGKILL);
      ::waitpid(holder_, nullptr, 0);
    }
  }

  std::string make() {
    const auto uid = ::getuid();
    const auto gid = ::getgid();
    if (::unshare(CLONE_NEWNET) != 0) {
      if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
        return std::string("network namespaces are not allowed here: ") + std::strerror(errno);
      }
      std::ofstream("/proc/self/setgroups") << "deny";
      std::ofstream("/proc/self/uid_map") << "0 " << uid << " 1";
      std::ofstream("/proc/self/gid_map") << "0 " << gid << " 1";
    }
    const int tun = ::open("/dev/net/tun", O_RDWR | O_CLOEXEC);
    if (tun < 0) return std::string("no TUN devices here: ") + std::strerror(errno);
    ::close(tun);
    if (std::system("ip -V > /dev/null 2>&1 && nsenter --version > /dev/null 2>&1") != 0) {
      return "the programs `ip` (iproute2) and `nsenter` (util-linux) are needed";
    }
    int ready[2];
    if (::pipe(ready) != 0) return "no pipe";
    holder_ = ::fork();
    if (holder_ == 0) {
      (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
      const char good = ::unshare(CLONE_NEWNET) == 0 ? 1 : 0;
      (void)!::write(ready[1], &good, 1);
      for (;;) ::pause();
    }
    char good = 0;
    (void)!::read(ready[0], &good, 1);
    ::close(ready[0]);
    ::close(ready[1]);
    if (good == 0 || std::system("ip link set lo up") != 0 || !in_slave("ip link set lo up")) {
      return "a second network namespace cannot be set up here";
    }
    return "";
  }

  pid_t holder_ = 0;
  std::string obstacle_;
};

/// A program on one side, its output in a file; whatever happens, it does not outlive this object.
class SidedProgram {
 public:
  SidedProgram(Side side, std::vector<std::string> command, std::string output) : output_(std::move(output)) {
    pid_ = Namespaces::instance().fork_on(side, [&] {
      const int fd = ::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      (void)::dup2(fd, STDOUT_FILENO);
      (void)::dup2(fd, STDERR_FILENO);
      std::vector<char*> arguments;
      arguments.reserve(command.size() + 1);
      for (auto& word : command) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execv(arguments.front(), arguments.data());
    });
  }
  ~SidedProgram() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  SidedProgram(const SidedProgram&) = delete;
  SidedProgram& operator=(const SidedProgram&) = delete;

  void interrupt() { ::kill(pid_, SIGINT); }
  void reload() { ::kill(pid_, SIGHUP); }
  /// Exit code, or -1 if it does not end in time.
  int wait(std::chrono::seconds timeout) {
    const auto end = std::chrono::steady_clock::now() + timeout;
    int status = 0;
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const {
    std::ifstream in(output_);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool says(const std::string& text, std::chrono::seconds timeout) const {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (output().find(text) == std::string::npos) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }

 private:
  std::string output_;
  pid_t pid_ = 0;
};

}  // namespace telekerf::integration
