#include "client/console/console_app.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "client/console/scene/scene_news.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"
#include "server/keys/secret.h"

namespace handrail {
namespace {

constexpr char kMapPath[] = "/scene/map.png";
constexpr Nanos kBetweenLines = 10 * kSecond;
constexpr std::uint16_t kPolicy = 1008;  // RFC 6455: what is not to be

bool offers(const WebRequest& request, const char* protocol) {
  return std::find(request.protocols.begin(), request.protocols.end(), protocol) !=
         request.protocols.end();
}

}  // namespace

ConsoleApp::ConsoleApp(Site site, PageDesk& desk, ViewerDesk& viewers, PageSink& pages)
    : site_(std::move(site)), desk_(desk), viewers_(viewers), pages_(pages) {}

bool ConsoleApp::is_time_to_say() {
  const Nanos now = monotonic_now();
  if (now - said_ <= kBetweenLines) return false;
  said_ = now;
  return true;
}

void ConsoleApp::let_in(Access access, LinkKeeper* links) {
  access_ = std::move(access);
  links_ = links;
  if (links == nullptr) return;
  links->watch([this](const Result<std::vector<OnceLink>>& now) {
    if (!now) return spdlog::warn("{}", now.message());
    std::vector<std::string> ids;
    for (const OnceLink& link : *now) ids.push_back(link.id);
    access_->keep_only(ids);
  });
}

void ConsoleApp::look() {
  const Nanos now = monotonic_now();
  for (const auto& [page, guest] : std::map(guests_)) {
    if (access_->holds(guest, now)) continue;
    guests_.erase(page);
    pages_.end(page, kPolicy,
               "the link of this page has ended: `handrail keys link` makes another");
  }
}

Access::Judged ConsoleApp::judge(const WebRequest& request) const {
  return access_ ? access_->judge(request, monotonic_now()) : Access::Judged{};
}

// Who knocks without the secret learns nothing; the log says from where, now and then.
WebAnswer ConsoleApp::refuse(const WebRequest& request) {
  if (is_time_to_say()) {
    spdlog::warn("refused {} (host '{}', origin '{}'): it does not show the secret of this console",
                 request.from, shown(request.host), shown(request.origin));
  }
  return access_ ? access_->refusal() : plain_answer(503, "not yet\n");
}

WebAnswer ConsoleApp::take_link(const WebRequest& request, std::string token) {
  if (links_ == nullptr) return refuse(request);
  if (!tokens_.take(request.network, monotonic_now())) {
    return plain_answer(429, "too many links are tried: open yours again in a few seconds\n");
  }
  WebAnswer out;
  out.later = [this, token = std::move(token), from = request.from](auto tell) {
    links_->take(token, [this, from, tell](const Result<OnceLinks::Taken>& taken) {
      tell(admit_by(taken, from));
    });
  };
  return out;
}

WebAnswer ConsoleApp::admit_by(const Result<OnceLinks::Taken>& taken, const std::string& from) {
  const auto secret = new_secret();
  if (!taken || !secret) {
    spdlog::warn("{} is not let in: {}", from, taken ? secret.message() : taken.message());
    return plain_answer(500, "links cannot be read or written: this console's log says why\n");
  }
  constexpr char kAnother[] = "`handrail keys link` makes another\n";
  switch (taken->found) {
    case OnceLinks::Found::kUnknown:
      return plain_answer(403, std::string("there is no such link (any more): ") + kAnother);
    case OnceLinks::Found::kUsed:
      spdlog::warn("{} has opened a link that is used already", from);
      return plain_answer(403,
                          std::string("this link has been opened before, and is good once. Was "
                                      "it not you? `handrail keys unlink` ends what it let "
                                      "in; ") +
                              kAnother);
    case OnceLinks::Found::kExpired:
      return plain_answer(403,
                          std::string("this link was good for a while that is over: ") + kAnother);
    case OnceLinks::Found::kGood: break;
  }
  const OnceLink& link = taken->link;
  spdlog::info("{} is let in by link {} as {}", from, link.id, role_text(link.role));
  return access_->let_in({link.role != Role::kOperator, link.id}, *secret,
                         monotonic_now() + OnceLinks::kSessionLife * kSecond);
}

WebAnswer ConsoleApp::answer(const WebRequest& request) {
  Access::Judged judged = judge(request);
  switch (judged.verdict) {
    case Access::Verdict::kRefused: return refuse(request);
    case Access::Verdict::kShowsKey: return access_->welcome();
    case Access::Verdict::kLooksAtLink: return Access::link_page();
    case Access::Verdict::kOpensLink: return take_link(request, std::move(judged.token));
    case Access::Verdict::kIn: break;
  }
  if (request.method != "GET" && request.method != "HEAD") {
    return plain_answer(405, "expected GET: orders go through the WebSocket\n");
  }
  const auto file = site_.find(request.target);
  return file ? *file : plain_answer(404, "there is no such file\n");
}

WebApplication::Admission ConsoleApp::admit(const WebRequest& request) {
  if (Access::is_for_viewers(request)) return admit_viewer(request);
  const Access::Judged judged = judge(request);
  if (judged.verdict != Access::Verdict::kIn) return {"", refuse(request)};
  if (request.target != "/ws") return {"", plain_answer(404, "the WebSocket is at /ws\n")};
  if (!offers(request, kConsoleProtocol)) {
    return {"",
            plain_answer(400, std::string("expected the subprotocol ") + kConsoleProtocol + "\n")};
  }
  if (desk_.pages() >= PageDesk::kMostPages) {
    return {"", plain_answer(503, std::to_string(PageDesk::kMostPages) +
                                      " pages are open, and more are not served: close one\n")};
  }
  return {kConsoleProtocol, {}, judged.guest};
}

WebApplication::Admission ConsoleApp::admit_viewer(const WebRequest& request) {
  bool shows_key = false;
  if (!access_ || !access_->lets_view(request, shows_key)) {
    if (!shows_key) return {"", refuse(request)};
    if (is_time_to_say()) {
      spdlog::warn("refused a viewer of origin '{0}' from {1}: it is let in by --viewer-origin {0}",
                   shown(request.origin), request.from);
    }
    return {"", access_->refusal()};
  }
  const auto protocol = std::find_if(kViewerProtocols.begin(), kViewerProtocols.end(),
                                     [&](const char* each) { return offers(request, each); });
  if (protocol == kViewerProtocols.end()) {
    return {"", plain_answer(400, std::string("expected the subprotocol ") + kViewerProtocols[0] +
                                      " or " + kViewerProtocols[1] + "\n")};
  }
  if (viewers_.viewers() >= ViewerDesk::kMostViewers) {
    return {"", plain_answer(503, std::to_string(ViewerDesk::kMostViewers) +
                                      " viewers look, and more are not served: close one\n")};
  }
  return {*protocol, {}};
}

void ConsoleApp::opened(PageId page, const std::string& protocol, const std::string&,
                        const Guest& guest) {
  if (protocol != kConsoleProtocol) return viewers_.opened(page, monotonic_now());
  if (!guest.link.empty()) guests_[page] = guest;
  desk_.opened(page, guest.observes, monotonic_now());
}

void ConsoleApp::received(PageId page, std::string_view frame, bool binary) {
  if (!viewers_.has(page)) return desk_.received(page, frame, monotonic_now());
  viewers_.received(page, frame, binary, {monotonic_now(), calendar_now()});
}

void ConsoleApp::closed(PageId page) {
  viewers_.closed(page);
  guests_.erase(page);
  desk_.closed(page, monotonic_now());
}

void ConsoleApp::show(const std::string& name, const Result<ReadScene>& read) {
  const std::string number = std::to_string(++scenes_);
  pb::SceneNews news;
  if (read) {
    if (!read->picture.png.empty())
      site_.put(kMapPath, "image/png", shared_text(read->picture.png));
    news = scene_news(read->scene, std::string(kMapPath) + "?" + number, read->picture.size);
  } else {
    news.set_problem(read.message());
  }
  news.set_name(name);
  news.set_number(number);
  desk_.scene(news);
  viewers_.scene(news, read ? read->picture.cells : MapCells{}, calendar_now());
}

}  // namespace handrail
