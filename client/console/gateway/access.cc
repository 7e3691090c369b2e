#include "client/console/gateway/access.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

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

}  // namespace

std::vector<std::pair<std::string, std::string>> safety_headers(const std::string& host) {
  // 'self' alone leaves WebSockets out in some browsers.
  const std::string socket = host.empty() ? std::string() : std::string(" ws://").append(host);
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

Result<std::string> new_secret() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    return Status::error(std::string("no random numbers: ") + std::strerror(errno));
  }
  std::string out;
  for (const unsigned char byte : bytes) {
    for (const unsigned digit : {byte / 16u, byte % 16u}) out += "0123456789abcdef"[digit];
  }
  return out;
}

Access::Access(std::string key, std::string cookie, const std::string& address, std::uint16_t port)
    : key_(std::move(key)),
      cookie_(std::move(cookie)),
      // Cookies of a host go to all its ports: another gateway's must not take this one's place.
      cookie_name_("handrail-console-" + std::to_string(port)) {
  const std::string end = std::string(":").append(std::to_string(port));
  hosts_ = {address + end, "localhost" + end};
}

bool Access::is_own_host(const std::string& host) const {
  return std::find(hosts_.begin(), hosts_.end(), lower(host)) != hosts_.end();
}

Access::Verdict Access::judge(const WebRequest& request) const {
  if (!is_own_host(request.host)) return Verdict::kRefused;
  const bool own_origin = lower(request.origin) == "http://" + lower(request.host);
  if (!request.origin.empty() && !own_origin) return Verdict::kRefused;
  if (request.wants_socket && !own_origin) return Verdict::kRefused;
  if (same(cookie_value(request.cookie, cookie_name_), cookie_)) return Verdict::kIn;
  constexpr std::string_view kShown = "/?key=";
  const std::string_view target = request.target;
  const bool shows = !request.wants_socket && target.starts_with(kShown) &&
                     same(target.substr(kShown.size()), key_);
  return shows ? Verdict::kShowsKey : Verdict::kRefused;
}

WebAnswer Access::welcome() const {
  WebAnswer out = plain_answer(303, "");
  out.more = {{"Location", "/"},
              {"Set-Cookie", cookie_name_ + "=" + cookie_ + "; HttpOnly; SameSite=Strict; Path=/"}};
  return out;
}

WebAnswer Access::refusal() {
  return plain_answer(403, "handrail-console: open the address that it printed when it started\n");
}

std::string Access::url() const { return "http://" + hosts_.front() + "/?key=" + key_; }

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
