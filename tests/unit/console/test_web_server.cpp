// SPDX-License-Identifier: Apache-2.0
// The server as others meet it: over sockets, with whatever they send.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <fstream>
#include <future>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "common/runtime/startup_error.h"
#include "master/console/connection_limits.h"
#include "master/console/page_files.h"
#include "master/console/web_server.h"

namespace telekerf::master {
namespace {

using boost::asio::ip::tcp;
namespace websocket = boost::beast::websocket;
const auto kLoopback = boost::asio::ip::address_v4::loopback();

class WebServerTest : public ::testing::Test {
 protected:
  ~WebServerTest() override {
    context.stop();
    thread.join();
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(server.port()); }
  /// What comes back until the server closes.
  std::string ask(const std::string& request) {
    boost::asio::io_context own;
    tcp::socket socket(own);
    socket.connect({kLoopback, server.port()});
    boost::asio::write(socket, boost::asio::buffer(request));
    std::string answer;
    boost::system::error_code error;
    boost::asio::read(socket, boost::asio::dynamic_buffer(answer), error);
    return answer;
  }
  std::string get(const std::string& target, const std::string& more = "") {
    return ask("GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n" + more +
               "\r\n");
  }
  nlohmann::json figures() {
    const std::string status = get("/status");
    return nlohmann::json::parse(status.substr(status.find("\r\n\r\n")));
  }
  static bool is(const std::string& answer, const char* status) {
    return answer.starts_with(std::string("HTTP/1.1 ") + status);
  }
  /// None: refused.
  bool upgrade(const std::string& asked_host, const std::string& origin) {
    boost::asio::io_context own;
    websocket::stream<tcp::socket> socket(own);
    socket.next_layer().connect({kLoopback, server.port()});
    socket.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
    }));
    boost::system::error_code error;
    socket.handshake(asked_host, "/ws", error);
    return !error;
  }

  boost::asio::io_context context{1};
  Console console{{.cell = "c", .source = "operator", .token = "secret-token", .profiles = {}, .epoch = 5}};
  WebServer server{
      context, {.bind = "127.0.0.1", .port = 0, .name = "", .token = "secret-token"}, console, [] {}};
  std::thread thread{[this] { context.run(); }};
};

TEST_F(WebServerTest, ServesThePageWithItsTokenAndNothingElse) {
  const std::string page = get("/");
  EXPECT_TRUE(is(page, "200")) << page;
  EXPECT_NE(page.find("content=\"secret-token\""), std::string::npos);
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_NE(get("/main.js").find("text/javascript"), std::string::npos);
  EXPECT_EQ(get("/main.js").find("secret-token"), std::string::npos);
  EXPECT_NE(get("/contour").find("{\"id\":0}"), std::string::npos);
  for (const char* none : {"/nothing", "/../main.cpp", "//", "/index.html/"})
    EXPECT_TRUE(is(get(none), "404")) << none;
  EXPECT_TRUE(is(get("/ws"), "426"));
  EXPECT_TRUE(is(ask("POST / HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n\r\n"), "405"));
}

TEST_F(WebServerTest, WhoAsksForTheHeadGetsNoBody) {
  for (const char* target : {"/", "/main.js", "/contour?id=1", "/status", "/nothing", "/runs"}) {
    const std::string head = ask("HEAD " + std::string(target) + " HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n\r\n");
    EXPECT_TRUE(head.ends_with("\r\n\r\n")) << target << ": " << head.substr(0, 2000);
    EXPECT_NE(head.find("Content-Length: "), head.npos) << target;
  }
  const std::string both = ask("HEAD / HTTP/1.1\r\nHost: " + host() + "\r\n\r\nGET /nothing HTTP/1.1\r\nHost: " + host() +
                               "\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(both.find("HTTP/1.1 404"), both.find("\r\n\r\n") + 4) << "the next answer follows the head";
}

TEST_F(WebServerTest, OneComputerThatTakesAllConnectionsItMayIsRefusedMoreWithASentence) {
  boost::asio::io_context own;
  std::vector<tcp::socket> held;
  for (int n = 0; n < ConnectionLimits::kMostOfOne; ++n) held.emplace_back(own).connect({kLoopback, server.port()});
  const std::string answer = get("/");
  EXPECT_TRUE(is(answer, "503")) << answer;
  EXPECT_TRUE(answer.ends_with("close a page\n")) << answer;
  held.clear();
  std::string page;
  for (int n = 0; n < 200 && !is(page, "200"); ++n, std::this_thread::sleep_for(std::chrono::milliseconds(10)))
    page = get("/");
  EXPECT_TRUE(is(page, "200"));
  EXPECT_GE(figures()["web_refused_connections"], 1);
  for (int n = 0; n < 200 && figures()["web_connections"] != 1; ++n)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(figures()["web_connections"], 1) << "every place is free again but the asker's own";
}

TEST_F(WebServerTest, WithoutAFileToOpenItWaitsSaysSoOnceAndGoesOn) {
  (void)get("/");
  boost::asio::io_context own;
  tcp::socket late(own, tcp::v4());
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{.rlim_cur = 256, .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<int> files;
  for (int file = 0; (file = ::open("/dev/null", O_RDONLY)) >= 0;) files.push_back(file);
  late.connect({kLoopback, server.port()});  // the operating system has taken it, the server cannot
  std::string said;
  std::int64_t now_ns = 0;
  const auto look = [&] {
    std::promise<std::string> told;
    boost::asio::post(context, [&] { told.set_value(server.due(now_ns += 20'000'000'000)); });
    said += told.get_future().get();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  };
  for (int n = 0; n < 10; ++n) look();
  for (const int file : files) ::close(file);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_NE(said.find("have to wait: Too many open files; close pages"), said.npos) << said;
  EXPECT_EQ(said.find("have to wait"), said.rfind("have to wait")) << "once";
  boost::asio::write(late, boost::asio::buffer("GET / HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n\r\n"));
  std::string answer;
  boost::system::error_code error;
  boost::asio::read(late, boost::asio::dynamic_buffer(answer), error);
  EXPECT_TRUE(is(answer, "200")) << "it goes on";
  const double waited = figures()["web_connections_waited"];
  EXPECT_GE(waited, 1);
  EXPECT_LT(waited, 100) << "and does not spin meanwhile";
}

TEST_F(WebServerTest, WhatIsCountedIsToldAndStandsInTheReference) {
  (void)get("/", "Origin: http://evil.example\r\n");
  EXPECT_NE(get("/status").find("Content-Type: application/json"), std::string::npos);
  const auto told = figures();
  EXPECT_EQ(told["web_refused_requests"], 1);
  std::ifstream in(TELEKERF_CONSOLE_PAGE);
  const std::string reference(std::istreambuf_iterator<char>(in), {});
  EXPECT_GE(told.size(), 12u);
  for (const auto& [name, value] : told.items())
    EXPECT_NE(reference.find("| `" + name + "` |"), reference.npos) << name;
}

TEST_F(WebServerTest, OtherNamesAndOtherPagesAreRefused) {
  EXPECT_TRUE(is(ask("GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n"), "421"));
  EXPECT_TRUE(is(get("/", "Origin: http://evil.example\r\n"), "403"));
  EXPECT_TRUE(upgrade(host(), "http://" + host()));
  EXPECT_TRUE(upgrade(host(), "")) << "no browser";
  EXPECT_FALSE(upgrade(host(), "http://evil.example"));
  EXPECT_FALSE(upgrade("evil.example:" + std::to_string(server.port()), ""));
}

TEST_F(WebServerTest, APageIsGreetedAndHeard) {
  boost::asio::io_context own;
  websocket::stream<tcp::socket> socket(own);
  socket.next_layer().connect({kLoopback, server.port()});
  socket.handshake(host(), "/ws");
  boost::beast::flat_buffer in;
  socket.read(in);
  const std::string hello = boost::beast::buffers_to_string(in.data());
  EXPECT_NE(hello.find("\"type\":\"hello\""), std::string::npos) << hello;
  socket.text(true);
  socket.write(boost::asio::buffer(std::string(R"({"do":"take","text":"secret-token"})")));
  bool leased = false;
  for (int n = 0; n < 20 && !leased; ++n) {
    in.clear();
    socket.read(in);
    leased = boost::beast::buffers_to_string(in.data()).find("\"type\":\"lease\"") != std::string::npos;
  }
  EXPECT_TRUE(leased);
}

TEST_F(WebServerTest, AnyBytesAreBorne) {
  std::mt19937 random(3);
  const auto noise = [&](std::size_t size) {
    std::string bytes(size, 0);
    for (char& c : bytes) c = static_cast<char>(random());
    return bytes;
  };
  for (int n = 0; n < 20; ++n) {
    boost::asio::io_context own;
    tcp::socket socket(own);
    socket.connect({kLoopback, server.port()});
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(noise(1 + random() % 3000)), ignored);
  }
  for (int n = 0; n < 20; ++n) {
    boost::asio::io_context own;
    websocket::stream<tcp::socket> socket(own);
    socket.next_layer().connect({kLoopback, server.port()});
    socket.handshake(host(), "/ws");
    boost::system::error_code ignored;
    socket.binary(n % 2 == 0);
    socket.write(boost::asio::buffer(n % 2 == 0 ? noise(random() % 5000) : std::string(random() % 5000, '{')),
                 ignored);
    boost::asio::write(socket.next_layer(), boost::asio::buffer(noise(300)), ignored);
  }
  EXPECT_TRUE(is(ask("GET / HTTP/1.1\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n"), "") ||
              ask("GET /" + std::string(20'000, 'x')).empty());
  EXPECT_TRUE(is(get("/"), "200")) << "and it still serves";
}

TEST_F(WebServerTest, APortThatIsTakenIsSaid) {
  boost::asio::io_context own;
  try {
    const WebServer other(own, {.bind = "127.0.0.1", .port = server.port(), .name = "", .token = "t"},
                          console, [] {});
    FAIL() << "two servers at one port";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("this port is taken by another program"), std::string::npos);
  }
}

TEST(PageFiles, AreSmallAndAskNobodyElse) {
  std::size_t all = 0;
  for (const PageFile& file : kPageFiles) {
    all += file.text.size();
    for (const std::string_view elsewhere : {"https://", "http://"}) {
      for (std::size_t at = file.text.find(elsewhere); at != file.text.npos;
           at = file.text.find(elsewhere, at + 1))
        EXPECT_TRUE(file.text.substr(at).starts_with("http://www.w3.org/2000/svg")) << file.name;
    }
  }
  EXPECT_GT(all, 10'000u);
  EXPECT_LE(all, 150'000u);
}

}  // namespace
}  // namespace telekerf::master
