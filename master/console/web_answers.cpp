// SPDX-License-Identifier: Apache-2.0
#include "master/console/web_answers.h"

#include <fmt/format.h>

#include <boost/beast/websocket/rfc6455.hpp>
#include <charconv>
#include <nlohmann/json.hpp>

#include "master/console/access.h"
#include "master/console/page_files.h"

namespace telekerf::master {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// Of "id=7", with more behind it or not; 0 of anything else.
std::uint32_t id_of(std::string_view query) {
  std::uint32_t id = 0;
  constexpr std::string_view kKey = "id=";
  if (query.starts_with(kKey)) std::from_chars(query.data() + kKey.size(), query.data() + query.size(), id);
  return id;
}

std::string index(std::string page, const boost::asio::ip::address& from, const std::string& token) {
  // The token is for who sits at this very host; all others have to be told it.
  constexpr std::string_view kPlace = "TELEKERF_TOKEN";
  if (const std::size_t place = page.find(kPlace); place != page.npos)
    page.replace(place, kPlace.size(), from.is_loopback() ? token : "");
  return page;
}

}  // namespace

WebResponse answer_to(const WebRequest& request, const boost::asio::ip::address& from, const WebSite& site) {
  const WebServerSettings& settings = site.settings;
  Console& console = site.console;
  const bool tls = !settings.certificate.empty();
  WebResponse response{http::status::ok, request.version()};
  response.keep_alive(request.keep_alive());
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  const auto say = [&response](http::status status, std::string_view type, std::string_view text) {
    response.result(status);
    response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response.body() = text;
    response.prepare_payload();
    return response;
  };
  constexpr std::string_view kPlain = "text/plain; charset=utf-8";
  const std::string_view host = view(request[http::field::host]);
  if (!host_allowed(host, settings.name, site.port))
    return say(http::status::misdirected_request, kPlain,
               "Ask by this host's address, or start telekerf-console with --host-name\n");
  // Not every browser takes a WebSocket of this host for 'self'.
  response.set("Content-Security-Policy",
               fmt::format("default-src 'self'; connect-src 'self' {}://{}; img-src "
                           "'self' blob:; frame-ancestors 'none'; base-uri 'none'",
                           tls ? "wss" : "ws", host));
  if (!origin_allowed(view(request[http::field::origin]), tls ? "https" : "http", host))
    return say(http::status::forbidden, kPlain, "Another page than this server's own\n");
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return say(http::status::method_not_allowed, kPlain, "Only GET\n");
  std::string_view target = view(request.target());
  const std::size_t query = target.find('?');
  const std::uint32_t id = query == target.npos ? 0 : id_of(target.substr(query + 1));
  target = target.substr(0, query);
  if (target == "/ws") {
    if (!websocket::is_upgrade(request))
      return say(http::status::upgrade_required, kPlain, "A WebSocket is spoken here\n");
    response.result(http::status::switching_protocols);
    return response;
  }
  if (RunQuestion question; parse_run_question(target, question)) {
    response.result(http::status::accepted);
    return response;
  }
  if (target == "/status")
    return say(http::status::ok, "application/json", nlohmann::json(site.figures()).dump(2) + "\n");
  if (target == "/contour") return say(http::status::ok, "application/json", console.contour_json(id));
  if (target == "/picture") {
    const auto picture = console.cell().pictures().find(id);
    if (picture == console.cell().pictures().end())
      return say(http::status::not_found, kPlain, "No picture of this contour\n");
    const auto& jpeg = picture->second.preview.jpeg;
    return say(http::status::ok, "image/jpeg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  }
  const std::string_view name = target == "/" ? "index.html" : target.substr(target.starts_with('/') ? 1 : 0);
  for (const PageFile& file : kPageFiles) {
    if (file.name != name) continue;
    if (name == "index.html")
      return say(http::status::ok, type_of(name), index(std::string(file.text), from, settings.token));
    return say(http::status::ok, type_of(name), file.text);
  }
  return say(http::status::not_found, kPlain, "Nothing is here\n");
}

}  // namespace telekerf::master
