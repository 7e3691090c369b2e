// The console as a web server's application.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "client/console/gateway/access.h"
#include "client/console/gateway/pace.h"
#include "client/console/gateway/page_desk.h"
#include "client/console/gateway/site.h"
#include "client/console/gateway/web.h"
#include "client/console/link_keeper.h"
#include "client/console/scene/read_scene.h"
#include "client/console/viewer/viewer_desk.h"
#include "server/base/status.h"

namespace handrail {

inline constexpr char kConsoleProtocol[] = "handrail.console.v1";

class ConsoleApp final : public WebApplication {
 public:
  // Tokens that are tried in a second, of all and of one network: each costs a look at the disk.
  static constexpr std::size_t kMostTokens = 20, kMostTokensOfNetwork = 4;

  // `desk`, `viewers` and `pages` must outlive it.
  ConsoleApp(Site site, PageDesk& desk, ViewerDesk& viewers, PageSink& pages);

  // Nobody is let in before. `links`, which must outlive it, is asked by who shows a token.
  void let_in(Access access, LinkKeeper* links = nullptr);
  // Pages whose session has ended are told so, once in a while.
  void look();

  WebAnswer answer(const WebRequest& request) override;
  Admission admit(const WebRequest& request) override;
  void opened(PageId page, const std::string& protocol, const std::string& from,
              const Guest& guest) override;
  void received(PageId page, std::string_view frame, bool binary) override;
  void closed(PageId page) override;

  // The scene that the master has, of that name, or why there is nothing to draw.
  void show(const std::string& name, const Result<ReadScene>& read);

 private:
  Access::Judged judge(const WebRequest& request) const;
  WebAnswer refuse(const WebRequest& request);
  Admission admit_viewer(const WebRequest& request);
  // True once in a while: what strangers do is not logged more often.
  bool is_time_to_say();
  // The answer to who shows that token comes when the disk has been asked.
  WebAnswer take_link(const WebRequest& request, std::string token);
  WebAnswer admit_by(const Result<OnceLinks::Taken>& taken, const std::string& from);

  std::optional<Access> access_;
  Site site_;
  PageDesk& desk_;
  ViewerDesk& viewers_;
  PageSink& pages_;
  LinkKeeper* links_ = nullptr;
  Pace tokens_{kMostTokensOfNetwork, kMostTokens};
  std::map<PageId, Guest> guests_;
  std::uint64_t scenes_ = 0;
  Nanos said_ = -kForever;  // when a refusal was logged last
};

}  // namespace handrail
