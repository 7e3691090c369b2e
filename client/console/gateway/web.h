// What a browser asks for and what it is told, without sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace handrail {

// The head of a request; what is not there is empty.
struct WebRequest {
  std::string method, target, host, origin, cookie;
  std::vector<std::string> protocols;  // offered for a WebSocket, in order
  bool wants_socket = false;           // to become a WebSocket
  std::string from;                    // address and port, for people
  std::string network;                 // where one of `from` may have all the others too
};

// Whom a browser was let in as.
struct Guest {
  bool observes = false;  // may look: no order passes
  std::string link;       // the id of the link that it came by; empty: the address that was printed
};

using SharedText = std::shared_ptr<const std::string>;
inline SharedText shared_text(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

struct WebAnswer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  SharedText body;
  std::vector<std::pair<std::string, std::string>> more = {};  // headers
  // Where it takes a while: told later, in the same thread, and nothing else of this counts.
  std::function<void(std::function<void(WebAnswer)>)> later = {};
};

inline WebAnswer plain_answer(unsigned status, std::string text) {
  WebAnswer out;
  out.status = status;
  out.body = shared_text(std::move(text));
  return out;
}

// Headers of every answer: nothing from elsewhere, nothing inline, nothing guessed, no frame around
// it. `host`: this gateway, as the browser calls it; empty: it is not known who asks.
std::vector<std::pair<std::string, std::string>> safety_headers(const std::string& host,
                                                                bool encrypted = false);

// A page's number at this gateway, from 1 on; never used again.
using PageId = std::uint32_t;

// What becomes of a frame that waits while an older one is on its way.
struct FrameWorth {
  // -1: none is ever left out. Else at most `most` of the same slot wait: the oldest is left out.
  int slot = -1;
  std::size_t most = 1;
};

// Frames to pages. In the gateway's thread.
class PageSink {
 public:
  virtual ~PageSink() = default;
  virtual void send(PageId page, SharedText frame, bool binary, FrameWorth worth) = 0;
  // Closes with a code of RFC 6455.
  virtual void end(PageId page, std::uint16_t code, const std::string& why) = 0;
};

// What a web server serves. All in its thread.
class WebApplication {
 public:
  virtual ~WebApplication() = default;
  virtual WebAnswer answer(const WebRequest& request) = 0;
  // The subprotocol to speak, or what refuses the WebSocket.
  struct Admission {
    std::string protocol;  // empty: refused
    WebAnswer refusal;
    Guest guest = {};
  };
  virtual Admission admit(const WebRequest& request) = 0;
  virtual void opened(PageId page, const std::string& protocol, const std::string& from,
                      const Guest& guest) = 0;
  virtual void received(PageId page, std::string_view frame, bool binary) = 0;
  virtual void closed(PageId page) = 0;
};

}  // namespace handrail
