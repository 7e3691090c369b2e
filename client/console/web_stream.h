// What of Beast the server is made of: a connection's bytes, encrypted or not, as one kind of
// stream, and the head of a request.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>

#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include "client/console/gateway/web.h"

namespace handrail {

// Times are set at next_layer(). Handlers are Asio's; nothing else is returned.
class WebStream {
 public:
  using next_layer_type = boost::beast::tcp_stream;
  using executor_type = next_layer_type::executor_type;

  // Plain bytes, as long as it is not encrypted.
  explicit WebStream(boost::asio::ip::tcp::socket socket) : stream_(Plain(std::move(socket))) {}

  // To be shaken hands with. What a stream that is encrypted has of its own, 70 KiB, is not there
  // before. Once, while nothing is under way.
  boost::beast::ssl_stream<next_layer_type>& encrypt(boost::asio::ssl::context& tls) {
    Plain plain = std::move(*std::get_if<Plain>(&stream_));
    return stream_.emplace<Tls>(std::move(plain), tls);
  }

  executor_type get_executor() noexcept { return next_layer().get_executor(); }
  next_layer_type& next_layer() noexcept {
    if (auto* tls = std::get_if<Tls>(&stream_)) return tls->next_layer();
    return *std::get_if<Plain>(&stream_);
  }
  // Null: not encrypted.
  boost::beast::ssl_stream<next_layer_type>* tls() noexcept { return std::get_if<Tls>(&stream_); }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& to, Handler&& handler) {
    read_some(List<boost::asio::mutable_buffer>(to), handler_of(std::forward<Handler>(handler)));
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& from, Handler&& handler) {
    write_some(List<boost::asio::const_buffer>(from), handler_of(std::forward<Handler>(handler)));
  }

 private:
  using Plain = next_layer_type;
  using Tls = boost::beast::ssl_stream<next_layer_type>;
  using Done = std::function<void(boost::beast::error_code, std::size_t)>;

  // The first of a sequence of buffers; some of them is all that a call asks for.
  template <typename Buffer>
  class List {
   public:
    using value_type = Buffer;
    using const_iterator = const Buffer*;
    template <typename Buffers>
    explicit List(const Buffers& from) {
      auto each = boost::asio::buffer_sequence_begin(from);
      const auto last = boost::asio::buffer_sequence_end(from);
      for (; each != last && count_ < of_.size(); ++each) of_[count_++] = *each;
    }
    const_iterator begin() const noexcept { return of_.data(); }
    const_iterator end() const noexcept { return of_.data() + count_; }

   private:
    std::array<Buffer, 8> of_{};
    std::size_t count_ = 0;
  };

  // A handler of Beast's can only be moved.
  template <typename Handler>
  static Done handler_of(Handler&& handler) {
    auto kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
    return [kept](boost::beast::error_code e, std::size_t size) { (*kept)(e, size); };
  }
  void read_some(const List<boost::asio::mutable_buffer>& to, Done done) {
    std::visit([&](auto& s) { s.async_read_some(to, std::move(done)); }, stream_);
  }
  void write_some(const List<boost::asio::const_buffer>& from, Done done) {
    std::visit([&](auto& s) { s.async_write_some(from, std::move(done)); }, stream_);
  }

  std::variant<Plain, Tls> stream_;
};

// Beast ends a WebSocket so, found by its argument.
template <typename Handler>
void async_teardown(boost::beast::role_type role, WebStream& stream, Handler&& handler) {
  if (auto* tls = stream.tls()) {
    return tls->async_shutdown(std::forward<Handler>(handler));
  }
  using boost::beast::websocket::async_teardown;
  async_teardown(role, stream.next_layer(), std::forward<Handler>(handler));
}

// The head of a request as the gateway looks at it, without from and network.
inline WebRequest read_head(const boost::beast::http::request_header<>& head) {
  namespace http = boost::beast::http;
  const auto text_of = [](boost::beast::string_view view) {
    return std::string(view.data(), view.size());
  };
  WebRequest out;
  out.method = text_of(head.method_string());
  out.target = text_of(head.target());
  // Twice said is once too often.
  if (head.count(http::field::host) == 1) out.host = text_of(head[http::field::host]);
  out.origin = text_of(head[http::field::origin]);
  out.cookie = text_of(head[http::field::cookie]);
  for (const auto& token : http::token_list(head[http::field::sec_websocket_protocol])) {
    out.protocols.push_back(text_of(token));
  }
  out.wants_socket = boost::beast::websocket::is_upgrade(head);
  return out;
}

}  // namespace handrail
