// SPDX-License-Identifier: Apache-2.0
#include "master/console/web_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <set>
#include <utility>

#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"
#include "master/console/connection_limits.h"
#include "master/console/dismissal.h"
#include "master/console/web_answers.h"

namespace telekerf::master {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace ssl = boost::asio::ssl;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;
using Request = WebRequest;
using Response = WebResponse;
using Error = beast::error_code;
using Plain = beast::tcp_stream;
using Encrypted = beast::ssl_stream<beast::tcp_stream>;

constexpr std::chrono::seconds kHttpPatience{5};
/// A file of a run over a slow line.
constexpr std::chrono::seconds kFilePatience{600};
/// A page that answers no ping for this long is gone.
constexpr std::chrono::seconds kSilence{3};
constexpr std::size_t kMostHeaderBytes = 8192;
constexpr std::size_t kMostMessageBytes = 4096;
/// After a connection that could not be taken.
constexpr std::chrono::milliseconds kTryAgain{100};
/// A page that takes its message no faster is slow.
constexpr std::int64_t kSlow_ns = 250'000'000;

}  // namespace

struct WebServer::Impl : std::enable_shared_from_this<Impl> {
  class Place;
  template <class Stream>
  class Http;
  /// A page's connection, whatever it is made of.
  struct Page {
    virtual ~Page() = default;
    virtual void pump() = 0;
    virtual void close() = 0;
  };
  template <class Stream>
  class PageOver;

  Impl(boost::asio::io_context& io, const WebServerSettings& chosen, Console& target,
       std::function<void()> on_heard)
      : context(io),
        settings(chosen),
        console(target),
        heard(std::move(on_heard)),
        acceptor(io),
        again(io),
        shelf(io, chosen.runs) {}

  void open();
  void encrypt();
  void accept();
  void greet(tcp::socket socket);
  Metrics figures() const;
  std::string_view scheme() const { return tls ? "https" : "http"; }

  boost::asio::io_context& context;
  WebServerSettings settings;
  Console& console;
  std::function<void()> heard;
  tcp::acceptor acceptor;
  boost::asio::steady_timer again;
  std::optional<ssl::context> tls;
  RunShelf shelf;
  std::uint16_t port = 0;
  std::set<Page*> pages;
  ConnectionLimits limits;
  Dismissal dismissal;
  std::uint64_t refused_requests = 0;
  std::uint64_t slow_writes = 0;
};

/// A connection's place among those that may be.
class WebServer::Impl::Place {
 public:
  /// That `from` was admitted to.
  Place(std::shared_ptr<Impl> server, boost::asio::ip::address from) : server_(std::move(server)), from_(std::move(from)) {}
  Place(Place&&) noexcept = default;
  Place& operator=(Place&&) = delete;
  ~Place() {
    if (server_) server_->limits.leave(from_);
  }
  const std::shared_ptr<Impl>& server() const noexcept { return server_; }
  const boost::asio::ip::address& from() const noexcept { return from_; }

 private:
  std::shared_ptr<Impl> server_;
  boost::asio::ip::address from_;
};

/// A page's WebSocket: reads all the time, and has one write on its way at most.
template <class Stream>
class WebServer::Impl::PageOver : public Page, public std::enable_shared_from_this<PageOver<Stream>> {
 public:
  PageOver(Place place, Stream stream)
      : place_(std::move(place)), server_(place_.server()), socket_(std::move(stream)) {}
  PageOver(const PageOver&) = delete;
  PageOver& operator=(const PageOver&) = delete;
  ~PageOver() override { leave(); }

  void accept(Request request) {
    Error ignored;
    beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
    socket_.read_message_max(kMostMessageBytes);
    socket_.set_option(websocket::stream_base::timeout{kHttpPatience, kSilence, true});
    request_ = std::move(request);
    socket_.async_accept(request_, [self = this->shared_from_this()](Error error) {
      if (error) return;
      self->id_ = self->server_->console.join(monotonic_ns());
      self->server_->pages.insert(self.get());
      self->read();
      self->pump();
    });
  }

  void pump() override {
    if (writing_ || id_ == 0) return;
    const std::optional<PageMessage> message = server_->console.next(id_, monotonic_ns());
    if (!message) return;
    writing_ = true;
    out_ = message->bytes;
    const std::int64_t begun_ns = monotonic_ns();
    socket_.binary(message->binary);
    socket_.async_write(boost::asio::buffer(out_),
                        [self = this->shared_from_this(), begun_ns](Error error, std::size_t) {
                          self->writing_ = false;
                          if (monotonic_ns() - begun_ns > kSlow_ns) ++self->server_->slow_writes;
                          if (error) return self->leave();
                          self->pump();
                        });
  }

  void close() override {
    leave();
    beast::get_lowest_layer(socket_).close();
  }

 private:
  void read() {
    socket_.async_read(in_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (error) return self->leave();
      self->take();
      self->read();
    });
  }
  void take() {
    const auto bytes = in_.cdata();
    const std::int64_t now_ns = monotonic_ns();
    if (socket_.got_binary())
      server_->console.hear_frame(id_, {static_cast<const std::byte*>(bytes.data()), bytes.size()}, now_ns);
    else
      server_->console.hear_command(id_, {static_cast<const char*>(bytes.data()), bytes.size()}, now_ns);
    in_.consume(in_.size());
    server_->heard();
    pump();
  }
  void leave() {
    if (id_ == 0) return;
    server_->pages.erase(this);
    server_->console.leave(std::exchange(id_, 0), monotonic_ns());
    server_->heard();
  }

  Place place_;
  std::shared_ptr<Impl> server_;
  websocket::stream<Stream, false> socket_;  // not compressed: the messages are short, and the page is near
  Request request_;
  beast::flat_buffer in_;
  std::string out_;
  bool writing_ = false;
  std::uint32_t id_ = 0;  ///< to the console; 0: not there (any more)
};

/// A connection that asks for files, one after the other, and may become a page's.
template <class Stream>
class WebServer::Impl::Http : public std::enable_shared_from_this<Http<Stream>> {
 public:
  Http(Place place, Stream stream)
      : place_(std::move(place)), server_(place_.server()), stream_(std::move(stream)) {}
  Http(const Http&) = delete;
  Http& operator=(const Http&) = delete;

  void start() {
    if constexpr (std::is_same_v<Stream, Encrypted>) {
      line().expires_after(kHttpPatience);
      stream_.async_handshake(ssl::stream_base::server, [self = this->shared_from_this()](Error error) {
        if (!error) self->read();
      });
    } else {
      read();
    }
  }

 private:
  beast::tcp_stream& line() { return beast::get_lowest_layer(stream_); }
  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeaderBytes);
    line().expires_after(kHttpPatience);
    http::async_read(stream_, buffer_, *parser_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (!error) self->take();
    });
  }
  void take() {
    Request request = parser_->release();
    head_ = request.method() == http::verb::head;
    response_ = answer_to(request, place_.from(),
                          {server_->settings, server_->port, server_->console, [this] { return server_->figures(); }});
    if (response_.result_int() >= 400) ++server_->refused_requests;
    if (response_.result() == http::status::accepted) return fetch(std::string(request.target()));
    if (response_.result() == http::status::switching_protocols) {
      line().expires_never();
      std::make_shared<PageOver<Stream>>(std::move(place_), std::move(stream_))->accept(std::move(request));
      return;
    }
    write(kHttpPatience);
  }
  /// Something of a recorded run, which takes its time.
  void fetch(const std::string& target) {
    RunQuestion question;
    parse_run_question(target, question);
    line().expires_never();
    server_->shelf.ask(question, [self = this->shared_from_this(), question](RunShelf::Answer answer) {
      self->response_.result(static_cast<unsigned>(answer.status));
      self->response_.set(http::field::content_type,
                          answer.status != 200       ? "text/plain; charset=utf-8"
                          : question.what.empty()    ? "application/json"
                                                     : "application/octet-stream");
      if (answer.status == 200 && !question.what.empty() && question.what != "playback")
        self->response_.set(http::field::content_disposition,
                            "attachment; filename=\"" + question.what + "\"");
      self->response_.body() = std::move(answer.bytes);
      self->response_.prepare_payload();
      self->write(kFilePatience);
    });
  }
  void write(std::chrono::seconds patience) {
    if (head_) response_.body().clear();  // its length stays said
    line().expires_after(patience);
    http::async_write(stream_, response_, [self = this->shared_from_this()](Error failed, std::size_t) {
      if (failed) return;
      if (self->response_.keep_alive()) return self->read();
      Error ignored;
      self->line().socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Place place_;
  std::shared_ptr<Impl> server_;
  Stream stream_;
  bool head_ = false;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
};

void WebServer::Impl::open() {
  const auto refuse = [this](const std::string& why, const std::string& remedy) {
    throw environment_error(
        fmt::format("port = {}, bind = {}: {}; {}", settings.port, settings.bind, why, remedy));
  };
  Error error;
  const auto address = boost::asio::ip::make_address(settings.bind, error);
  if (error) refuse("no address of this host", "give one, such as 127.0.0.1");
  acceptor.open(address.is_v4() ? tcp::v4() : tcp::v6(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind({address, settings.port}, error);
  if (!error) acceptor.listen(boost::asio::socket_base::max_listen_connections, error);
  if (error == boost::asio::error::address_in_use)
    refuse("this port is taken by another program", "end that, or give another one: --port N");
  if (error) refuse(error.message(), "give an address of this host and a free port");
  port = acceptor.local_endpoint().port();
}

void WebServer::Impl::encrypt() {
  if (settings.certificate.empty()) return;
  tls.emplace(ssl::context::tls_server);
  const auto take = [this](const char* flag, const std::string& file, auto use) {
    Error error;
    use(file, error);
    if (error)
      throw configuration_error(fmt::format(
          "{} = {}: {}; give a certificate and its key as PEM files, such as "
          "`openssl req -x509 -newkey rsa:2048 -nodes -keyout key.pem -out cert.pem -subj /CN=cell` makes",
          flag, file, error.message()));
  };
  take("tls_cert", settings.certificate,
       [this](const std::string& file, Error& error) { tls->use_certificate_chain_file(file, error); });
  take("tls_key", settings.key, [this](const std::string& file, Error& error) {
    tls->use_private_key_file(file, ssl::context::pem, error);
  });
}

void WebServer::Impl::accept() {
  acceptor.async_accept([self = shared_from_this()](Error error, tcp::socket socket) {
    if (error == boost::asio::error::operation_aborted) return;
    if (!error) {
      self->greet(std::move(socket));
      return self->accept();
    }
    // Too many open files, mostly: whoever wants in stays where it is, and asking at once would only spin.
    self->limits.wait(error.message());
    self->again.expires_after(kTryAgain);
    self->again.async_wait([self](Error) {
      if (self->acceptor.is_open()) self->accept();
    });
  });
}

void WebServer::Impl::greet(tcp::socket socket) {
  Error error;
  const tcp::endpoint from = socket.remote_endpoint(error);
  if (error) return;
  if (!limits.admit(from.address())) {
    if (!tls) dismissal.say(std::move(socket));
    return;
  }
  Place place(shared_from_this(), from.address());
  if (tls)
    std::make_shared<Http<Encrypted>>(std::move(place), Encrypted(Plain(std::move(socket)), *tls))->start();
  else
    std::make_shared<Http<Plain>>(std::move(place), Plain(std::move(socket)))->start();
}

Metrics WebServer::Impl::figures() const {
  Metrics figures;
  console.add_figures(figures);
  figures["web_connections"] = limits.open();
  figures["web_refused_connections"] = static_cast<double>(limits.refused());
  figures["web_connections_waited"] = static_cast<double>(limits.waits());
  figures["web_refused_requests"] = static_cast<double>(refused_requests);
  figures["web_slow_writes"] = static_cast<double>(slow_writes);
  shelf.add_figures(figures);
  return figures;
}

WebServer::WebServer(boost::asio::io_context& context, const WebServerSettings& settings, Console& console,
                     std::function<void()> heard)
    : impl_(std::make_shared<Impl>(context, settings, console, std::move(heard))) {
  impl_->encrypt();
  impl_->open();
  impl_->accept();
}

WebServer::~WebServer() {
  Error ignored;
  impl_->acceptor.close(ignored);
  impl_->again.cancel();
  impl_->heard = [] {};
  for (Impl::Page* page : std::set(impl_->pages)) page->close();
}

std::uint16_t WebServer::port() const { return impl_->port; }

std::string WebServer::address() const {
  const auto address = impl_->acceptor.local_endpoint().address();
  const std::string host = address.to_string();
  return fmt::format("{}://{}:{}", impl_->scheme(), address.is_v6() ? fmt::format("[{}]", host) : host,
                     impl_->port);
}

Metrics WebServer::figures() const { return impl_->figures(); }

std::string WebServer::due(std::int64_t now_ns) { return impl_->limits.due(now_ns); }

void WebServer::pump() {
  for (Impl::Page* page : std::set(impl_->pages)) page->pump();
}

}  // namespace telekerf::master
