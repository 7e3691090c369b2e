#include "client/console/gateway/access.h"

#include <algorithm>
#include <utility>

namespace handrail {
namespace {

constexpr std::string_view kViewerPath = "/foxglove";
constexpr std::string_view kViewerShows = "/foxglove?key=";

bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

constexpr std::string_view kKeyTarget = "/?key=";
constexpr std::string_view kLinkTarget = "/?once=";
constexpr std::size_t kLongestToken = 64;  // ours has 32

// It has no word of whoever asks. Without a Referrer-Policy of its own its POST would say Origin
// null (Fetch, "append a request Origin header").
constexpr char kLinkPage[] =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
    "content=\"width=device-width\"><link rel=\"icon\" href=\"data:,\"><title>Handrail</title>"
    "<style>:root{color-scheme:dark light;font:1rem system-ui}body{margin:20vh "
    "auto;max-width:24rem;"
    "padding:0 1rem}button{font:inherit;padding:.7rem 1.2rem}</style><h1>Handrail</h1><p>This link "
    "opens the console once, in this browser.</p><form method=\"post\"><button autofocus>Open the "
    "console</button></form></html>\n";
constexpr char kLinkPolicy[] =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; form-action 'self'; base-uri "
    "'none'; frame-ancestors 'none'";

}  // namespace

std::vector<std::pair<std::string, std::string>> safety_headers(const std::string& host,
                                                                bool encrypted) {
  // 'self' alone leaves WebSockets out in some browsers.
  const std::string socket =
      host.empty() ? std::string() : (encrypted ? " wss://" : " ws://") + host;
  return {
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src "
       "'self'; connect-src 'self'" +
           socket + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"}};
}

Access::Access(GatewayPlace place, std::string key, std::string cookie)
    : place_(std::move(place)),
      key_(std::move(key)),
      cookie_(std::move(cookie)),
      // Cookies of a host go to all its ports: another gateway's must not take this one's place.
      cookie_name_("handrail-console-" + std::to_string(place_.port)) {
  for (const std::string& name : place_.names) {
    hosts_.push_back(name + ":" + std::to_string(place_.port));
    // Browsers leave out the port that is the usual one.
    if (place_.encrypted && place_.port == 443) hosts_.push_back(name);
  }
}

bool Access::is_own_host(const std::string& host) const {
  return std::find(hosts_.begin(), hosts_.end(), lower(host)) != hosts_.end();
}

Access::Judged Access::judge(const WebRequest& request, Nanos now) const {
  if (!is_own_host(request.host)) return {};
  const bool own_origin = lower(request.origin) == scheme() + lower(request.host);
  if (!request.origin.empty() && !own_origin) return {};
  if (request.wants_socket && !own_origin) return {};
  const std::string shown = cookie_value(request.cookie, cookie_name_);
  const std::string_view target = request.target;
  // Also of who is in already: as an observer, for one.
  if (place_.encrypted && !request.wants_socket && target.starts_with(kLinkTarget) &&
      target.size() <= kLinkTarget.size() + kLongestToken) {
    if (request.method == "GET") return {Verdict::kLooksAtLink, {}, {}};
    // The button's; a page from elsewhere lets nobody in here.
    if (request.method == "POST" && own_origin) {
      return {Verdict::kOpensLink, {}, std::string(target.substr(kLinkTarget.size()))};
    }
  }
  if (!cookie_.empty() && same(shown, cookie_)) return {Verdict::kIn, {}, {}};
  for (const Session& session : sessions_) {
    if (now < session.until && same(shown, session.secret)) {
      return {Verdict::kIn, session.guest, {}};
    }
  }
  const bool shows_key = !key_.empty() && !request.wants_socket && target.starts_with(kKeyTarget) &&
                         same(target.substr(kKeyTarget.size()), key_);
  return {shows_key ? Verdict::kShowsKey : Verdict::kRefused, {}, {}};
}

std::pair<std::string, std::string> Access::cookie_of(const std::string& secret) const {
  return {"Set-Cookie", cookie_name_ + "=" + secret + "; HttpOnly; SameSite=Strict; Path=/" +
                            (place_.encrypted ? "; Secure" : "")};
}

WebAnswer Access::welcome() const {
  WebAnswer out = plain_answer(303, "");
  out.more = {{"Location", "/"}, cookie_of(cookie_)};
  return out;
}

WebAnswer Access::link_page() {
  WebAnswer out = plain_answer(200, kLinkPage);
  out.type = "text/html; charset=utf-8";
  out.more = {{"Content-Security-Policy", kLinkPolicy}, {"Referrer-Policy", "same-origin"}};
  return out;
}

WebAnswer Access::let_in(const Guest& guest, std::string secret, Nanos until) {
  if (sessions_.size() >= kMostSessions) sessions_.erase(sessions_.begin());
  WebAnswer out = plain_answer(303, "");
  out.more = {{"Location", "/"}, cookie_of(secret)};
  sessions_.push_back({std::move(secret), guest, until});
  return out;
}

bool Access::holds(const Guest& guest, Nanos now) const {
  return guest.link.empty() ||
         std::any_of(sessions_.begin(), sessions_.end(), [&](const Session& session) {
           return session.guest.link == guest.link && now < session.until;
         });
}

void Access::keep_only(const std::vector<std::string>& links) {
  std::erase_if(sessions_, [&](const Session& session) {
    return std::find(links.begin(), links.end(), session.guest.link) == links.end();
  });
}

WebAnswer Access::refusal() const {
  return plain_answer(403, place_.encrypted
                               ? "handrail-console: open a link that `handrail keys link` made\n"
                               : "handrail-console: open the address that it printed when it "
                                 "started\n");
}

std::string Access::url() const {
  return scheme() + hosts_.front() + "/" +
         (key_.empty() ? std::string() : std::string(kKeyTarget.substr(1)) + key_);
}

void Access::open_to_viewers(std::string key, std::vector<std::string> origins) {
  viewer_key_ = std::move(key);
  for (std::string& origin : origins) viewer_origins_.push_back(lower(std::move(origin)));
}

bool Access::is_for_viewers(const WebRequest& request) {
  const std::string_view target = request.target;
  return target.substr(0, target.find('?')) == kViewerPath;
}

bool Access::lets_view(const WebRequest& request, bool& shows_key) const {
  const std::string_view target = request.target;
  shows_key = !viewer_key_.empty() && is_own_host(request.host) &&
              target.starts_with(kViewerShows) &&
              same(target.substr(kViewerShows.size()), viewer_key_);
  const bool known =
      request.origin.empty() || std::find(viewer_origins_.begin(), viewer_origins_.end(),
                                          lower(request.origin)) != viewer_origins_.end();
  return shows_key && known;
}

std::string Access::viewer_url() const {
  return "ws://" + hosts_.front() + std::string(kViewerShows) + viewer_key_;
}

std::string cookie_value(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(';'), header.size());
    std::string_view pair = header.substr(0, end);
    header.remove_prefix(std::min(end + 1, header.size()));
    while (pair.starts_with(' ')) pair.remove_prefix(1);
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) {
      return std::string(pair.substr(equals + 1));
    }
  }
  return {};
}

}  // namespace handrail
