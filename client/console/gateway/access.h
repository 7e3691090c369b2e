// Who may see the console: whoever has the address that it printed, or a link that is good once.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/console/gateway/web.h"
#include "server/base/time.h"

namespace handrail {

// Where a gateway is found.
struct GatewayPlace {
  std::vector<std::string> names;  // hosts and addresses as an address has them, lower case
  std::uint16_t port = 0;          // that is listened on
  bool encrypted = false;          // other computers reach it
};

// A request is judged by three things. Its Host must be this gateway, so that no name of somebody
// else's that leads here (DNS rebinding) is served. Its Origin, if it has one, must be this
// gateway, and a WebSocket must have one, so that no page from elsewhere speaks. And it must show a
// secret: the cookie of a session; or, to get one, on this computer the key in the address that was
// printed, from others the token of a link. Secrets are compared in constant time.
//
// A link is good once, and programs that show what is behind an address GET it (RFC 9110, 9.2.1: a
// GET changes nothing). So it is used up by a POST, of the button of the page that a GET shows.
class Access {
 public:
  enum class Verdict { kIn, kShowsKey, kLooksAtLink, kOpensLink, kRefused };
  struct Judged {
    Verdict verdict = Verdict::kRefused;
    Guest guest = {};   // kIn
    std::string token;  // kOpensLink: not looked at yet
  };
  static constexpr std::size_t kMostSessions = 64;  // by links; the oldest goes

  // `key`, `cookie`: of the address that was printed; without them there is none.
  Access(GatewayPlace place, std::string key, std::string cookie);

  Judged judge(const WebRequest& request, Nanos now) const;
  // To `/`, with the cookie, for kShowsKey.
  WebAnswer welcome() const;
  // The page with the button, for kLooksAtLink: the same for whatever token.
  static WebAnswer link_page();
  // To `/`, with the cookie of a session for `guest`, of that secret.
  WebAnswer let_in(const Guest& guest, std::string secret, Nanos until);
  // Whether that guest's session still is.
  bool holds(const Guest& guest, Nanos now) const;
  // Sessions by links that are not among these end.
  void keep_only(const std::vector<std::string>& links);
  // The same for whatever was wrong: it tells a stranger nothing.
  WebAnswer refusal() const;
  // With the key: to be printed once.
  std::string url() const;
  bool encrypted() const noexcept { return place_.encrypted; }

  // Viewers (Foxglove, Lichtblick) cannot be given a cookie: their WebSocket shows a secret of its
  // own in its address, which opens nothing else. `origins`: of pages that are viewers.
  void open_to_viewers(std::string key, std::vector<std::string> origins);
  static bool is_for_viewers(const WebRequest& request);
  // Whether the secret is right and a page it comes from is one of the viewers. A program says no
  // Origin. The answer to the first alone is in `shows_key`.
  bool lets_view(const WebRequest& request, bool& shows_key) const;
  std::string viewer_url() const;

 private:
  struct Session {
    std::string secret;
    Guest guest;
    Nanos until;
  };
  bool is_own_host(const std::string& host) const;
  std::string scheme() const { return place_.encrypted ? "https://" : "http://"; }
  std::pair<std::string, std::string> cookie_of(const std::string& secret) const;

  GatewayPlace place_;
  std::string key_, cookie_, cookie_name_;
  std::vector<std::string> hosts_;  // HOST:PORT
  std::string viewer_key_;          // empty: no viewer is let in
  std::vector<std::string> viewer_origins_;
  std::vector<Session> sessions_;  // by links, the oldest first
};

// The value of a cookie in a Cookie header (RFC 6265); empty: it is not there.
std::string cookie_value(std::string_view header, std::string_view name);

}  // namespace handrail
