// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket around the console, with TLS or without: the page's files, /contour, /picture, /runs, /run,
// /status, and /ws.
// All in one thread, the io_context's.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "master/console/console.h"
#include "master/console/run_shelf.h"

namespace telekerf::master {

struct WebServerSettings {
  std::string bind = "127.0.0.1";  ///< address of this host
  std::uint16_t port = 8080;       ///< 0: any free one
  std::string name;                ///< host name by which the page may be asked for, beside addresses
  std::string token;               ///< stands in the page that is served to this host itself
  std::string certificate = {};    ///< PEM file, with those above it; without: plain HTTP
  std::string key = {};            ///< PEM file
  RunShelfSettings runs = {};
};

class WebServer {
 public:
  /// `heard`: called whenever a page has said something. Throws StartupError: the address is not of this
  /// host, the port is taken, or certificate and key are none.
  WebServer(boost::asio::io_context& context, const WebServerSettings& settings, Console& console,
            std::function<void()> heard);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  /// "http://127.0.0.1:8080"
  std::string address() const;
  /// Gives each page what it is to get next, as far as it can take it.
  void pump();
  /// What this server and its console count, under the names of docs/reference/console.md; /status tells them, too.
  Metrics figures() const;
  /// One sentence of connections that were refused; mostly empty.
  std::string due(std::int64_t now_ns);

  struct Impl;

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace telekerf::master
