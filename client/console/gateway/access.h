// Who may see the console: whoever has the address that it printed.
#pragma once

#include <string>

#include "client/console/gateway/web.h"
#include "server/base/status.h"

namespace handrail {

// 32 random characters, 128 bits, fit for an address and a cookie.
Result<std::string> new_secret();

// A request is judged by three things. Its Host must be this gateway, so that no name of somebody
// else's that leads here (DNS rebinding) is served. Its Origin, if it has one, must be this
// gateway, and a WebSocket must have one, so that no page from elsewhere speaks. And it must show a
// secret: the key in the address that was printed, which is answered with a cookie for a secret of
// its own, or that cookie. Secrets are compared in constant time.
class Access {
 public:
  enum class Verdict { kIn, kShowsKey, kRefused };

  // `port`: that is listened on; `address`: of this computer, as an address writes it.
  Access(std::string key, std::string cookie, const std::string& address, std::uint16_t port);

  Verdict judge(const WebRequest& request) const;
  // To `/`, with the cookie, for kShowsKey.
  WebAnswer welcome() const;
  // The same for whatever was wrong: it tells a stranger nothing.
  static WebAnswer refusal();
  // With the key: to be printed once.
  std::string url() const;

  // Viewers (Foxglove, Lichtblick) cannot be given a cookie: their WebSocket shows a secret of its
  // own in its address, which opens nothing else. `origins`: of pages that are viewers.
  void open_to_viewers(std::string key, std::vector<std::string> origins);
  static bool is_for_viewers(const WebRequest& request);
  // Whether the secret is right and a page it comes from is one of the viewers. A program says no
  // Origin. The answer to the first alone is in `shows_key`.
  bool lets_view(const WebRequest& request, bool& shows_key) const;
  std::string viewer_url() const;

 private:
  bool is_own_host(const std::string& host) const;

  std::string key_, cookie_, cookie_name_;
  std::vector<std::string> hosts_;  // HOST:PORT
  std::string viewer_key_;          // empty: no viewer is let in
  std::vector<std::string> viewer_origins_;
};

// The value of a cookie in a Cookie header (RFC 6265); empty: it is not there.
std::string cookie_value(std::string_view header, std::string_view name);

}  // namespace handrail
