// The console as a web server's application.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "client/console/gateway/access.h"
#include "client/console/gateway/page_desk.h"
#include "client/console/gateway/site.h"
#include "client/console/gateway/web.h"
#include "client/console/scene/map_picture.h"
#include "client/console/viewer/viewer_desk.h"
#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

inline constexpr char kConsoleProtocol[] = "handrail.console.v1";

// A scene read for the pages.
struct ReadScene {
  Scene scene;
  MapPicture picture;  // of walls
};

class ConsoleApp final : public WebApplication {
 public:
  // `desk` and `viewers` must outlive it.
  ConsoleApp(Site site, PageDesk& desk, ViewerDesk& viewers);

  // Nobody is let in before.
  void let_in(Access access) { access_ = std::move(access); }

  WebAnswer answer(const WebRequest& request) override;
  Admission admit(const WebRequest& request) override;
  void opened(PageId page, const std::string& protocol, const std::string& from) override;
  void received(PageId page, std::string_view frame, bool binary) override;
  void closed(PageId page) override;

  // The scene that the master has, of that name, or why there is nothing to draw.
  void show(const std::string& name, const Result<ReadScene>& read);

 private:
  Access::Verdict judge(const WebRequest& request) const {
    return access_ ? access_->judge(request) : Access::Verdict::kRefused;
  }
  WebAnswer refuse(const WebRequest& request);
  Admission admit_viewer(const WebRequest& request);
  // True once in a while: what strangers do is not logged more often.
  bool is_time_to_say();

  std::optional<Access> access_;
  Site site_;
  PageDesk& desk_;
  ViewerDesk& viewers_;
  std::uint64_t scenes_ = 0;
  Nanos said_ = -kForever;  // when a refusal was logged last
};

}  // namespace handrail
