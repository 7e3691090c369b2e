#include "client/console/console_app.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "client/console/scene/scene_news.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr char kMapPath[] = "/scene/map.png";
constexpr Nanos kBetweenLines = 10 * kSecond;

bool offers(const WebRequest& request, const char* protocol) {
  return std::find(request.protocols.begin(), request.protocols.end(), protocol) !=
         request.protocols.end();
}

}  // namespace

ConsoleApp::ConsoleApp(Site site, PageDesk& desk, ViewerDesk& viewers)
    : site_(std::move(site)), desk_(desk), viewers_(viewers) {}

bool ConsoleApp::is_time_to_say() {
  const Nanos now = monotonic_now();
  if (now - said_ <= kBetweenLines) return false;
  said_ = now;
  return true;
}

// Who knocks without the secret learns nothing; the log says from where, now and then.
WebAnswer ConsoleApp::refuse(const WebRequest& request) {
  if (is_time_to_say()) {
    spdlog::warn("refused {} (host '{}', origin '{}'): it does not show the secret of this console",
                 request.from, shown(request.host), shown(request.origin));
  }
  return Access::refusal();
}

WebAnswer ConsoleApp::answer(const WebRequest& request) {
  switch (judge(request)) {
    case Access::Verdict::kRefused: return refuse(request);
    case Access::Verdict::kShowsKey: return access_->welcome();
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
  if (judge(request) != Access::Verdict::kIn) return {"", refuse(request)};
  if (request.target != "/ws") return {"", plain_answer(404, "the WebSocket is at /ws\n")};
  if (!offers(request, kConsoleProtocol)) {
    return {"",
            plain_answer(400, std::string("expected the subprotocol ") + kConsoleProtocol + "\n")};
  }
  if (desk_.pages() >= PageDesk::kMostPages) {
    return {"", plain_answer(503, std::to_string(PageDesk::kMostPages) +
                                      " pages are open, and more are not served: close one\n")};
  }
  return {kConsoleProtocol, {}};
}

WebApplication::Admission ConsoleApp::admit_viewer(const WebRequest& request) {
  bool shows_key = false;
  if (!access_ || !access_->lets_view(request, shows_key)) {
    if (!shows_key) return {"", refuse(request)};
    if (is_time_to_say()) {
      spdlog::warn("refused a viewer of origin '{0}' from {1}: it is let in by --viewer-origin {0}",
                   shown(request.origin), request.from);
    }
    return {"", Access::refusal()};
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

void ConsoleApp::opened(PageId page, const std::string& protocol, const std::string& from) {
  if (protocol == kConsoleProtocol) return desk_.opened(page, from, monotonic_now());
  viewers_.opened(page, monotonic_now());
}

void ConsoleApp::received(PageId page, std::string_view frame, bool binary) {
  if (!viewers_.has(page)) return desk_.received(page, frame, monotonic_now());
  viewers_.received(page, frame, binary, {monotonic_now(), calendar_now()});
}

void ConsoleApp::closed(PageId page) {
  viewers_.closed(page);
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
