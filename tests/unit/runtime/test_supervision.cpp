// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <string>

#include "common/runtime/supervision.h"

namespace telekerf {
namespace {

/// The end at which a service manager listens.
class ServiceManager : public testing::Test {
 protected:
  void SetUp() override {
    fd_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const std::string name = "@telekerf-supervision-" + std::to_string(::getpid());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path, name.size());
    address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    ASSERT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  void TearDown() override {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(fd_);
  }
  /// What was said since, or nothing.
  std::string heard() const {
    std::array<char, 256> room{};
    const ssize_t size = ::recv(fd_, room.data(), room.size(), MSG_DONTWAIT);
    return size < 0 ? "" : std::string(room.data(), static_cast<std::size_t>(size));
  }

 private:
  int fd_ = -1;
};

TEST_F(ServiceManager, HearsOfAProcessWhenItsLoopBegins) {
  Supervision supervision;
  supervision.tell();
  EXPECT_EQ(heard(), "") << "nothing has begun";
  supervision.step();
  supervision.tell();
  EXPECT_EQ(heard(), "READY=1\nWATCHDOG=1");
  supervision.step();
  supervision.tell();
  EXPECT_EQ(heard(), "WATCHDOG=1") << "ready is said once";
}

TEST_F(ServiceManager, IsNotFedForALoopThatHangs) {
  Supervision supervision;
  supervision.step();
  supervision.tell();
  (void)heard();
  for (int n = 0; n < 10; ++n) supervision.tell();
  EXPECT_EQ(heard(), "");
  supervision.step();
  supervision.tell();
  EXPECT_EQ(heard(), "WATCHDOG=1") << "it goes on";
}

TEST_F(ServiceManager, WaitsForWhatIsLeftToDoAfterTheLoop) {
  Supervision supervision;
  supervision.step();
  supervision.tell();
  (void)heard();
  supervision.over();
  supervision.tell();
  EXPECT_EQ(heard(), "WATCHDOG=1");
}

TEST(NoServiceManager, IsNoReasonToWait) {
  ::unsetenv("NOTIFY_SOCKET");
  EXPECT_FALSE(notify_service_manager("READY=1"));
  ::setenv("NOTIFY_SOCKET", "/nowhere/at/all", 1);
  EXPECT_FALSE(notify_service_manager("READY=1"));
  ::setenv("NOTIFY_SOCKET", std::string(200, 'x').c_str(), 1);
  EXPECT_FALSE(notify_service_manager("READY=1")) << "longer than any address";
  ::unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace telekerf
