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

}  // namespace

ConsoleApp::ConsoleApp(Site site, PageDesk& desk) : site_(std::move(site)), desk_(desk) {}

// Who knocks without the secret learns nothing; the log says from where, now and then.
WebAnswer ConsoleApp::refuse(const WebRequest& request) {
  if (const Nanos now = monotonic_now(); now - said_ > kBetweenLines) {
    said_ = now;
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
  if (judge(request) != Access::Verdict::kIn) return {"", refuse(request)};
  const auto offers = [&](const char* protocol) {
    return std::find(request.protocols.begin(), request.protocols.end(), protocol) !=
           request.protocols.end();
  };
  if (request.target != "/ws") return {"", plain_answer(404, "the WebSocket is at /ws\n")};
  if (!offers(kConsoleProtocol)) {
    return {"",
            plain_answer(400, std::string("expected the subprotocol ") + kConsoleProtocol + "\n")};
  }
  if (desk_.pages() >= PageDesk::kMostPages) {
    return {"", plain_answer(503, std::to_string(PageDesk::kMostPages) +
                                      " pages are open, and more are not served: close one\n")};
  }
  return {kConsoleProtocol, {}};
}

void ConsoleApp::opened(PageId page, const std::string&, const std::string& from) {
  desk_.opened(page, from, monotonic_now());
}

void ConsoleApp::received(PageId page, std::string_view frame, bool) {
  desk_.received(page, frame, monotonic_now());
}

void ConsoleApp::closed(PageId page) { desk_.closed(page, monotonic_now()); }

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
}

}  // namespace handrail
