// SPDX-License-Identifier: Apache-2.0
// What the server answers to a request: the page's files, /contour, /picture; who may ask at all.
#pragma once

#include <boost/asio/ip/address.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "master/console/console.h"
#include "master/console/web_server.h"

namespace telekerf::master {

using WebRequest = boost::beast::http::request<boost::beast::http::empty_body>;
using WebResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// What is asked.
struct WebSite {
  const WebServerSettings& settings;
  std::uint16_t port = 0;  ///< that is served
  Console& console;
  std::function<Metrics()> figures;  ///< that /status tells
};

/// Two answers are not the last word: "switching protocols" (a WebSocket is meant, and may be) and "accepted"
/// (something of a recorded run is, RunShelf). The answer to HEAD is that to GET; its body has to be left out.
WebResponse answer_to(const WebRequest& request, const boost::asio::ip::address& from, const WebSite& site);

}  // namespace telekerf::master
