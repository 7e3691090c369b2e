#include "client/console/request_head.h"

#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

namespace handrail {

namespace http = boost::beast::http;

WebRequest read_head(const http::request_header<>& head) {
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
