// A browser's part of HTTP and WebSockets, as a test speaks it.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <type_traits>
#include <utility>

#include <google/protobuf/util/json_util.h>

#include "proto/console.pb.h"
#include "server/base/clock.h"
#include "server/base/time.h"

namespace handrail {

namespace beast = boost::beast;
using boost::asio::ip::tcp;

inline tcp::endpoint console_at(int port) {
  return {boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)};
}

struct WebReply {
  unsigned status = 0;  // 0: the connection was closed without an answer
  std::string body, location, cookie;
  std::string attributes;  // of the cookie, after its value
};

using PlainBytes = beast::tcp_stream;
using TlsBytes = beast::ssl_stream<beast::tcp_stream>;

// Of a browser that was told to take whatever certificate is shown.
inline boost::asio::ssl::context& taking_all() {
  static boost::asio::ssl::context out(boost::asio::ssl::context::tls_client);
  return out;
}

// Connects `next`, with a handshake where it is encrypted.
template <typename Bytes>
void connect_web(Bytes& next, int port, beast::error_code& error) {
  beast::get_lowest_layer(next).socket().connect(console_at(port), error);
  if constexpr (std::is_same_v<Bytes, TlsBytes>) {
    if (!error) next.handshake(boost::asio::ssl::stream_base::client, error);
  }
}

// One request over `stream`, with headers as given; the answer.
template <typename Bytes>
WebReply web_ask(Bytes& stream, int port, const std::string& target, const std::string& headers,
                 const std::string& method = "GET") {
  beast::error_code error;
  connect_web(stream, port, error);
  const std::string text = method + " " + target + " HTTP/1.1\r\n" + headers + "\r\n";
  boost::asio::write(stream, boost::asio::buffer(text), error);
  beast::flat_buffer buffer;
  beast::http::response<beast::http::string_body> answer;
  beast::http::read(stream, buffer, answer, error);
  WebReply out;
  if (error) return out;
  out.status = answer.result_int();
  out.body = answer.body();
  out.location = std::string(answer[beast::http::field::location]);
  const std::string cookie(answer[beast::http::field::set_cookie]);
  const std::size_t end = std::min(cookie.find(';'), cookie.size());
  out.cookie = cookie.substr(0, end);
  out.attributes = cookie.substr(end);
  return out;
}
inline WebReply web_get(int port, const std::string& target, const std::string& headers) {
  boost::asio::io_context io;
  PlainBytes stream(io);
  return web_ask(stream, port, target, headers);
}
inline WebReply tls_get(int port, const std::string& target, const std::string& headers,
                        const std::string& method = "GET") {
  boost::asio::io_context io;
  TlsBytes stream(io, taking_all());
  return web_ask(stream, port, target, headers, method);
}

// A page's WebSocket. Every wait ends.
template <typename Bytes>
class WebPageOver {
 public:
  struct Asks {
    std::string host, origin, cookie;
    std::string protocol = "handrail.console.v1";
    std::string target = "/ws";
  };

  // Why it is not let in: the status and the body; empty: it is.
  std::string open(int port, const Asks& asks) {
    beast::error_code error;
    connect_web(socket_.next_layer(), port, error);
    if (error) return error.message();
    socket_.set_option(
        beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
          request.set(beast::http::field::origin, asks.origin);
          request.set(beast::http::field::cookie, asks.cookie);
          request.set(beast::http::field::sec_websocket_protocol, asks.protocol);
        }));
    socket_.read_message_max(4u << 20);
    beast::websocket::response_type answer;
    socket_.handshake(answer, asks.host, asks.target, error);
    if (!error) protocol_ = std::string(answer[beast::http::field::sec_websocket_protocol]);
    if (!error) return "";
    if (error != beast::websocket::error::upgrade_declined) return error.message();
    // What it was refused with is not said there: once more.
    const std::string upgrade =
        "Upgrade: websocket\r\nConnection: upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: ";
    constexpr bool kTls = std::is_same_v<Bytes, TlsBytes>;
    const std::string head = "Host: " + asks.host + "\r\nOrigin: " + asks.origin +
                             "\r\nCookie: " + asks.cookie + "\r\n" + upgrade + asks.protocol +
                             "\r\n";
    return std::to_string(
        (kTls ? tls_get(port, asks.target, head) : web_get(port, asks.target, head)).status);
  }
  bool say(const std::string& text) {
    beast::error_code error;
    socket_.text(true);
    socket_.write(boost::asio::buffer(text), error);
    return !error;
  }
  // The next frame, within `patience`; nothing: none came, or the connection has ended.
  std::optional<std::string> next(Nanos patience) {
    beast::flat_buffer buffer;
    std::optional<beast::error_code> result;
    socket_.async_read(buffer, [&](beast::error_code e, std::size_t) { result = e; });
    io_.restart();
    io_.run_for(std::chrono::nanoseconds(patience));
    if (!result) {
      beast::error_code ignored;
      beast::get_lowest_layer(socket_).socket().close(ignored);
      io_.restart();
      io_.run();
      ended_ = true;
      return std::nullopt;
    }
    if (*result) {
      ended_ = true;
      return std::nullopt;
    }
    return beast::buffers_to_string(buffer.cdata());
  }
  std::optional<pb::ToPage> next_frame(Nanos patience) {
    const auto text = next(patience);
    if (!text) return std::nullopt;
    pb::ToPage out;
    if (!google::protobuf::util::JsonStringToMessage(*text, &out).ok()) return std::nullopt;
    return out;
  }
  // The first frame that `f` takes, within `patience`.
  template <typename F>
  std::optional<pb::ToPage> wait_for(Nanos patience, F f) {
    for (const Nanos give_up = monotonic_now() + patience; monotonic_now() < give_up;) {
      std::optional<pb::ToPage> frame = next_frame(give_up - monotonic_now());
      if (!frame) return std::nullopt;
      if (f(*frame)) return frame;
    }
    return std::nullopt;
  }
  // The reply to what is said with this id.
  std::optional<pb::PageReply> ask(const std::string& text, std::uint32_t id, Nanos patience) {
    if (!say(text)) return std::nullopt;
    const auto frame = wait_for(
        patience, [&](const pb::ToPage& f) { return f.has_reply() && f.reply().id() == id; });
    return frame ? std::optional(frame->reply()) : std::nullopt;
  }
  bool has_ended() const { return ended_; }
  std::uint16_t close_code() const { return socket_.reason().code; }
  const std::string& protocol() const { return protocol_; }
  // The socket goes without a word, as of a browser that is killed.
  void vanish() {
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }
  auto& socket() { return socket_; }

 private:
  boost::asio::io_context io_;
  static auto make(boost::asio::io_context& io) {
    if constexpr (std::is_same_v<Bytes, TlsBytes>) {
      return beast::websocket::stream<Bytes>(io, taking_all());
    } else {
      return beast::websocket::stream<Bytes>(io);
    }
  }
  beast::websocket::stream<Bytes> socket_ = make(io_);
  bool ended_ = false;
  std::string protocol_;
};
using WebPage = WebPageOver<PlainBytes>;
using TlsPage = WebPageOver<TlsBytes>;

}  // namespace handrail
