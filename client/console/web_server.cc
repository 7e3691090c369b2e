#include "client/console/web_server.h"

#include <algorithm>
#include <chrono>
#include <list>
#include <map>
#include <optional>
#include <utility>

#include <openssl/ssl.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "client/console/gateway/outbox.h"
#include "client/console/gateway/pace.h"
#include "client/console/peer_place.h"
#include "client/console/web_stream.h"
#include "server/base/clock.h"
#include "server/keys/own_socket.h"

namespace handrail {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Error = beast::error_code;

namespace {

constexpr int kSendBuffer = 32 << 10;  // of a slow page's frames, beside ours: 0.1 s [bytes]
constexpr auto kAcceptPause = std::chrono::milliseconds(20);
// Between two looks whether a greeting is there: soon at first, then seldom, as thousands may wait.
constexpr Nanos kFirstKnock = 2 * kMillisecond, kLastKnock = 100 * kMillisecond;
constexpr auto kLastRead = std::chrono::seconds(1);
// Whoever means to say something has this long for it, however many others come.
constexpr Nanos kAtLeast = 100 * kMillisecond;

std::chrono::nanoseconds ns(Nanos time) { return std::chrono::nanoseconds(time); }

}  // namespace

struct WebServer::Parts {
  explicit Parts(asio::io_context& context) : io(context), acceptor(context), pause(context) {}

  void accept();
  void accept_later();
  // One that is answered goes, or of those that want nothing yet the one that has taken longest.
  // False: none, as all have only just come.
  bool make_room();
  void forget(const Connection* connection);
  void drop(std::shared_ptr<Connection> connection);
  // Null: it is gone.
  std::shared_ptr<Connection> page(PageId id) const {
    const auto found = pages.find(id);
    return found == pages.end() ? nullptr : found->second;
  }

  asio::io_context& io;
  WebApplication* application = nullptr;
  std::optional<asio::ssl::context> tls;  // none: plain bytes
  Pace handshakes{kMostHandshakesOfNetwork, kMostHandshakes};
  tcp::acceptor acceptor;
  asio::steady_timer pause;
  std::list<std::shared_ptr<Connection>> connections;  // the oldest first
  std::map<PageId, std::shared_ptr<Connection>> pages;
  PageId next_page = 1;
};

class WebServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Parts& parts)
      : stream_(std::move(socket)), parts_(parts), slow_(parts.io) {}

  void begin() {
    Error error;
    const auto peer = layer().socket().remote_endpoint(error);
    if (error) return close();
    from_ = peer_text(peer);
    network_ = network_of(peer);
    parser_.header_limit(kMostHeader);
    parser_.body_limit(0);
    layer().expires_after(ns(kHeaderPatience));
    if (!parts_.tls) return hear();
    give_up_ = monotonic_now() + kHeaderPatience;
    knock(kFirstKnock);
  }
  Nanos came() const { return came_; }
  bool has_asked() const { return has_asked_; }
  bool is_answered() const { return is_answered_; }
  PageId page() const { return page_; }
  void close() {
    Error ignored;
    slow_.cancel();
    layer().socket().close(ignored);
    if (const PageId page = std::exchange(page_, 0); page != 0) {
      parts_.pages.erase(page);
      parts_.application->closed(page);
    }
    parts_.forget(this);
  }
  void put(Outbox::Item item) {
    if (ending_) return;
    if (!outbox_.put(std::move(item))) return end(1008, "too many frames wait to be read");
    if (!writing_) write();
  }
  void end(std::uint16_t code, const std::string& why) {
    if (std::exchange(ending_, true)) return;
    // A reason has at most 123 bytes there.
    reason_.code = code;
    reason_.reason.assign(why.data(), std::min<std::size_t>(why.size(), 120));
    if (!writing_) say_end();
  }

 private:
  using Socket = websocket::stream<WebStream>;

  beast::tcp_stream& layer() {
    return socket_ ? beast::get_lowest_layer(*socket_) : stream_.next_layer();
  }
  // Nobody's turn is spent on who does not say all of its greeting; who has none yet waits for one.
  void knock(Nanos wait);
  void hear() {
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](Error e, std::size_t) { self->asked(e); });
  }
  void asked(Error error);
  WebRequest request_of() const;
  void answer(WebAnswer answer, const std::string& host);
  void become_page(const WebApplication::Admission& admission);
  void read();
  void write();
  void say_end();
  void limit_time();
  void count_control();

  WebStream stream_;
  Parts& parts_;
  asio::steady_timer slow_;  // for what is on its way to a page
  beast::flat_buffer buffer_{kMostHeader + kMostFrame};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  std::optional<Socket> socket_;
  std::string from_, network_;
  Nanos give_up_ = 0;  // its greeting
  const Nanos came_ = monotonic_now();
  bool has_asked_ = false, is_answered_ = false;
  PageId page_ = 0;
  Outbox outbox_;
  SharedText on_its_way_;
  bool writing_ = false, ending_ = false;
  websocket::close_reason reason_;
  Pace controls_{kMostControls, kMostControls};
};

void WebServer::Connection::knock(Nanos wait) {
  const Greeting greeting = greeting_of(layer().socket());
  if (greeting == Greeting::kNone || monotonic_now() + wait > give_up_) return close();
  if (greeting == Greeting::kWhole && parts_.handshakes.take(network_, monotonic_now())) {
    layer().expires_after(ns(kHeaderPatience));
    return stream_.encrypt(*parts_.tls)
        .async_handshake(asio::ssl::stream_base::server, [self = shared_from_this()](Error error) {
          if (error) return self->close();
          self->hear();
        });
  }
  slow_.expires_after(ns(wait));
  slow_.async_wait([self = shared_from_this(), wait](Error ended) {
    if (!ended) self->knock(std::min(2 * wait, kLastKnock));
  });
}

void WebServer::Connection::asked(Error error) {
  has_asked_ = true;
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    return answer(plain_answer(431, "the head of a request has at most 8 KiB\n"), "");
  }
  const bool has_body = !error && (parser_.content_length().value_or(0) != 0 || parser_.chunked());
  if (has_body || error == http::error::body_limit) {
    return answer(plain_answer(413, "a request has no body here\n"), "");
  }
  if (error) return close();
  const WebRequest request = request_of();
  if (!request.wants_socket) {
    return answer(parts_.application->answer(request), request.host);
  }
  const WebApplication::Admission admission = parts_.application->admit(request);
  if (admission.protocol.empty()) return answer(admission.refusal, request.host);
  become_page(admission);
}

WebRequest WebServer::Connection::request_of() const {
  WebRequest out = read_head(parser_.get());
  out.from = from_;
  out.network = network_;
  return out;
}

void WebServer::Connection::answer(WebAnswer answer, const std::string& host) {
  if (answer.later) {
    return answer.later([self = shared_from_this(), host](WebAnswer now) {
      if (self->layer().socket().is_open()) self->answer(std::move(now), host);
    });
  }
  response_.result(answer.status);
  response_.version(11);
  for (const auto& [name, value] :
       safety_headers(answer.status < 400 ? host : "", stream_.tls() != nullptr)) {
    response_.set(name, value);
  }
  for (const auto& [name, value] : answer.more) response_.set(name, value);
  response_.set(http::field::content_type, answer.type);
  response_.keep_alive(false);
  if (answer.body) response_.body() = *answer.body;
  response_.prepare_payload();
  const bool head_only = parser_.is_header_done() && parser_.get().method() == http::verb::head;
  if (head_only) response_.body().clear();
  layer().expires_after(ns(kAnswerPatience));
  http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
    if (error) return self->close();
    self->is_answered_ = true;
    // What is unread would take the answer back on its way: let the other side close.
    Error ignored;
    self->layer().socket().shutdown(tcp::socket::shutdown_send, ignored);
    self->buffer_.clear();
    self->layer().expires_after(kLastRead);
    self->layer().async_read_some(self->buffer_.prepare(4096),
                                  [self](Error, std::size_t) { self->close(); });
  });
}

void WebServer::Connection::become_page(const WebApplication::Admission& admission) {
  Error ignored;
  layer().expires_never();
  layer().socket().set_option(tcp::no_delay(true), ignored);
  layer().socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  socket_.emplace(std::move(stream_));
  websocket::stream_base::timeout times{};
  times.handshake_timeout = ns(kAnswerPatience);
  times.idle_timeout = ns(kIdle);
  times.keep_alive_pings = true;
  socket_->set_option(times);
  socket_->set_option(websocket::stream_base::decorator(
      [protocol = admission.protocol](websocket::response_type& r) {
        r.set(http::field::sec_websocket_protocol, protocol);
      }));
  socket_->read_message_max(kMostFrame);
  socket_->auto_fragment(false);
  socket_->control_callback([this](websocket::frame_type, beast::string_view) { count_control(); });
  // It counts from here on; its frames wait until it has its answer.
  page_ = parts_.next_page++;
  parts_.pages[page_] = shared_from_this();
  writing_ = true;
  parts_.application->opened(page_, admission.protocol, from_, admission.guest);
  socket_->async_accept(parser_.get(), [self = shared_from_this()](Error error) {
    if (error) return self->close();
    self->read();
    self->write();
  });
}

// A flood of pings is answered one by one otherwise.
void WebServer::Connection::count_control() {
  if (!controls_.take({}, monotonic_now())) end(1008, "too many pings");
}

void WebServer::Connection::read() {
  buffer_.clear();
  socket_->async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
    if (error) return self->close();
    if (self->page_ == 0) return;
    const auto data = self->buffer_.cdata();
    self->parts_.application->received(self->page_,
                                       {static_cast<const char*>(data.data()), data.size()},
                                       self->socket_->got_binary());
    self->read();
  });
}

void WebServer::Connection::write() {
  writing_ = false;
  if (ending_) return say_end();
  auto item = outbox_.next();
  if (!item || page_ == 0) return;
  writing_ = true;
  on_its_way_ = std::move(item->frame);
  socket_->binary(item->binary);
  limit_time();
  socket_->async_write(asio::buffer(*on_its_way_),
                       [self = shared_from_this()](Error error, std::size_t) {
                         self->slow_.cancel();
                         if (error) return self->close();
                         self->write();
                       });
}

void WebServer::Connection::limit_time() {
  slow_.expires_after(ns(kSlow));
  slow_.async_wait([self = shared_from_this()](Error ended) {
    if (!ended) self->close();
  });
}

void WebServer::Connection::say_end() {
  limit_time();
  socket_->async_close(reason_, [self = shared_from_this()](Error) { self->close(); });
}

void WebServer::Parts::accept() {
  if (connections.size() >= kMostConnections && !make_room()) return accept_later();
  acceptor.async_accept([this](Error error, tcp::socket socket) {
    if (error == asio::error::operation_aborted || !acceptor.is_open()) return;
    if (error == asio::error::no_descriptors && make_room()) return accept();
    if (error) return accept_later();
    connections.push_back(std::make_shared<Connection>(std::move(socket), *this));
    const auto kept = connections.back();  // it may end at once
    kept->begin();
    accept();
  });
}

void WebServer::Parts::accept_later() {
  pause.expires_after(kAcceptPause);
  pause.async_wait([this](Error ended) {
    if (!ended) accept();
  });
}

bool WebServer::Parts::make_room() {
  const Nanos early = monotonic_now() - kAtLeast;
  const auto drop_first = [&](const auto& may_go) {
    const auto found = std::find_if(connections.begin(), connections.end(), may_go);
    if (found == connections.end()) return false;
    drop(*found);
    return true;
  };
  return drop_first([](const auto& each) { return each->is_answered(); }) ||
         drop_first([&](const auto& each) { return !each->has_asked() && each->came() < early; }) ||
         drop_first([&](const auto& each) { return each->page() == 0 && each->came() < early; });
}

// A copy: closing takes it from the list that it is in.
void WebServer::Parts::drop(std::shared_ptr<Connection> connection) { connection->close(); }

void WebServer::Parts::forget(const Connection* connection) {
  connections.remove_if([&](const auto& each) { return each.get() == connection; });
}

WebServer::WebServer(asio::io_context& io) : parts_(std::make_unique<Parts>(io)) {}
WebServer::~WebServer() { close(); }

Status WebServer::open(const std::string& address, std::uint16_t port, WebApplication& application,
                       std::shared_ptr<SSL_CTX> tls) {
  parts_->application = &application;
  if (tls != nullptr) show(std::move(tls));
  Status opened = open_own(parts_->acceptor, {"console", "give --listen another port, or 0 for any",
                                              address, port, "another handrail-console"});
  if (opened) parts_->accept();
  return opened;
}

void WebServer::show(std::shared_ptr<SSL_CTX> tls) {
  SSL_CTX_up_ref(tls.get());  // the other's reference; each connection has one of its own
  parts_->tls.emplace(tls.get());
}

std::uint16_t WebServer::port() const {
  Error ignored;
  return parts_->acceptor.local_endpoint(ignored).port();
}

void WebServer::close() {
  Error ignored;
  parts_->acceptor.close(ignored);
  parts_->pause.cancel();
  while (!parts_->connections.empty()) parts_->drop(parts_->connections.front());
}

void WebServer::send(PageId page, SharedText frame, bool binary, FrameWorth worth) {
  if (const auto found = parts_->page(page)) found->put({std::move(frame), binary, worth});
}

void WebServer::end(PageId page, std::uint16_t code, const std::string& why) {
  if (const auto found = parts_->page(page)) found->end(code, why);
}

std::size_t WebServer::connections() const { return parts_->connections.size(); }

}  // namespace handrail
