// SPDX-License-Identifier: Apache-2.0
// The page by https, for browsers on other hosts.
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/runtime/startup_error.h"
#include "master/console/web_server.h"

namespace telekerf::master {
namespace {

namespace beast = boost::beast;
namespace ssl = boost::asio::ssl;
using boost::asio::ip::tcp;
using Stream = beast::ssl_stream<beast::tcp_stream>;

class WebTls : public ::testing::Test {
 protected:
  WebTls()
      : folder(std::filesystem::path(testing::TempDir()) / ("telekerf_tls_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder);
    const std::string make = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=cell -keyout " +
                             key() + " -out " + certificate() + " 2>/dev/null";
    made = std::system(make.c_str()) == 0;
  }
  ~WebTls() override {
    context.stop();
    if (thread.joinable()) thread.join();
    server.reset();
    std::filesystem::remove_all(folder);
  }
  std::string certificate() const { return (folder / "cert.pem").string(); }
  std::string key() const { return (folder / "key.pem").string(); }
  WebServerSettings settings() const {
    return {.bind = "127.0.0.1",
            .port = 0,
            .name = "",
            .token = "secret-token",
            .certificate = certificate(),
            .key = key()};
  }
  void serve() {
    server.emplace(context, settings(), console, [] {});
    thread = std::thread([this] { context.run(); });
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(server->port()); }

  template <class Next>
  void connect(Next& stream) {
    beast::get_lowest_layer(stream).connect(
        tcp::endpoint(boost::asio::ip::address_v4::loopback(), server->port()));
  }
  std::string refusal(const WebServerSettings& wrong) {
    try {
      const WebServer other(context, wrong, console, [] {});
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder;
  bool made = false;
  boost::asio::io_context context{1};
  Console console{{.cell = "c", .source = "operator", .token = "secret-token", .profiles = {}, .epoch = 5}};
  std::optional<WebServer> server;
  std::thread thread;
};

TEST_F(WebTls, ServesThePageAndItsSocketUnderTheGivenCertificate) {
  ASSERT_TRUE(made) << "openssl makes no certificate";
  serve();
  EXPECT_EQ(server->address(), "https://" + host());
  boost::asio::io_context own;
  ssl::context trust(ssl::context::tls_client);
  trust.load_verify_file(certificate());
  trust.set_verify_mode(ssl::verify_peer);
  {
    Stream stream(own, trust);
    connect(stream);
    stream.handshake(ssl::stream_base::client);
    beast::http::request<beast::http::empty_body> ask(beast::http::verb::get, "/", 11);
    ask.set(beast::http::field::host, host());
    ask.set(beast::http::field::origin, "https://" + host());
    beast::http::write(stream, ask);
    beast::flat_buffer buffer;
    beast::http::response<beast::http::string_body> page;
    beast::http::read(stream, buffer, page);
    EXPECT_EQ(page.result_int(), 200u);
    EXPECT_NE(page.body().find("secret-token"), std::string::npos);
    EXPECT_NE(std::string(page["Content-Security-Policy"]).find("wss://" + host()), std::string::npos);
  }
  beast::websocket::stream<Stream> socket(own, trust);
  connect(socket);
  socket.next_layer().handshake(ssl::stream_base::client);
  socket.handshake(host(), "/ws");
  beast::flat_buffer in;
  socket.read(in);
  EXPECT_NE(beast::buffers_to_string(in.data()).find("\"type\":\"hello\""), std::string::npos);
}

TEST_F(WebTls, PlainHttpIsNoAnswerThere) {
  ASSERT_TRUE(made);
  serve();
  boost::asio::io_context own;
  beast::tcp_stream stream(own);
  connect(stream);
  beast::http::request<beast::http::empty_body> ask(beast::http::verb::get, "/", 11);
  ask.set(beast::http::field::host, host());
  beast::http::write(stream, ask);
  beast::flat_buffer buffer;
  beast::http::response<beast::http::string_body> page;
  beast::error_code error;
  beast::http::read(stream, buffer, page, error);
  EXPECT_TRUE(error);
}

TEST_F(WebTls, WhatIsNoCertificateIsRefusedWithItsFile) {
  ASSERT_TRUE(made);
  WebServerSettings wrong = settings();
  wrong.certificate = (folder / "none.pem").string();
  EXPECT_NE(refusal(wrong).find("tls_cert = " + wrong.certificate + ": "), std::string::npos)
      << refusal(wrong);
  wrong = settings();
  wrong.key = certificate();
  EXPECT_NE(refusal(wrong).find("tls_key = " + wrong.key + ": "), std::string::npos) << refusal(wrong);
  EXPECT_NE(refusal(wrong).find("openssl req"), std::string::npos) << "the remedy";
}

}  // namespace
}  // namespace telekerf::master
