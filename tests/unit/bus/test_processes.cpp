// SPDX-License-Identifier: Apache-2.0
// Two real processes: blocks cross, a killed one leaves nothing behind and can be replaced at once.
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <filesystem>
#include <set>

#include "common/runtime/clock.h"
#include "tests/unit/bus/cell.h"

namespace telekerf {
namespace {

/// The echoing slave, killed without warning when it goes out of scope.
class Slave {
 public:
  explicit Slave(const BusSettings& settings) {
    const std::string domain = std::to_string(settings.domain);
    const char* arguments[] = {TELEKERF_BUS_ECHO, domain.c_str(), settings.cell.c_str(), nullptr};
    EXPECT_EQ(posix_spawn(&pid_, arguments[0], nullptr, nullptr, const_cast<char**>(arguments), environ), 0);
  }
  ~Slave() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Slave(const Slave&) = delete;
  Slave& operator=(const Slave&) = delete;

 private:
  pid_t pid_ = -1;
};

std::set<std::string> shared_memory_files() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
    names.insert(entry.path().filename());
  return names;
}

/// Writes until an answer comes: the first blocks may be lost while the two find each other.
void expect_answers(Writer<CommandBlock>& commands, Reader<StateBlock>& states, int count) {
  std::uint32_t sequence = 0;
  int answers = 0;
  ASSERT_TRUE(soon([&] {
    CommandBlock command;
    command.sequence = ++sequence;
    command.sent_ns = monotonic_ns();
    command.payload.size = 60;
    EXPECT_TRUE(commands.write(command));
    if (const auto state = take_soon(states, 50ms)) {
      ++answers;
      EXPECT_LE(state->value.echo_sequence, sequence);
      EXPECT_GT(state->received_ns, state->value.echo_sent_ns);
      EXPECT_EQ(state->value.payload.size, 60);
    }
    return answers == count;
  }));
}

TEST(Processes, BlocksCrossAndAKilledOneIsReplacedAtOnce) {
  const auto before = shared_memory_files();
  const BusSettings ours = settings("master");
  Bus master(ours);
  Writer<CommandBlock> commands(master);
  Reader<StateBlock> states(master);
  for (int life = 0; life < 2; ++life) {
    const Slave slave(ours);
    expect_answers(commands, states, 50);
  }
  for (const std::string& name : shared_memory_files()) {
    EXPECT_TRUE(before.count(name) == 1 || name.find("fast") == std::string::npos) << name;
  }
}

}  // namespace
}  // namespace telekerf
