// What pages ask for, and what they are told: who leads, which orders pass.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/console/gateway/play_orders.h"
#include "client/console/gateway/web.h"
#include "proto/console.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// What the desk has the master do. In the gateway's thread; nobody waits.
class MasterOrders {
 public:
  virtual ~MasterOrders() = default;
  // Answered by PageDesk::answered with the same ticket, once. A stop waits for no other order.
  virtual void order(std::uint64_t ticket, const pb::Request& request) = 0;
  // What is not answered yet is taken back, as far as it can be.
  virtual void withdraw(std::uint64_t ticket) = 0;
  // The newest counts. Answered by PageDesk::pointed, not one by one.
  virtual void point(const pb::CursorOrder& cursor) = 0;
};

struct PageDeskOptions {
  bool observe = false;               // no order of any page passes
  std::string version, name, master;  // as in pb::Hello
  std::vector<std::string> scenes = {};
};

// What is shown in place of a master: a recording.
struct PlayedRecording {
  pb::RecordingNews news;
  PlayOrders* orders = nullptr;  // outlives the desk; null: there is none, and a master is there
};

// One page leads at a time. Its orders and its cursor pass, and a stop of any page. When it goes,
// its cursor is let go at once and what it waits for is withdrawn. Sans IO; times are of one clock.
class PageDesk {
 public:
  static constexpr std::uint32_t kMostPages = 50;
  static constexpr std::uint32_t kMostRequests = 8;  // of a page, that are not answered yet
  static constexpr int kMostFrames = 500;            // from a page in a second
  static constexpr double kStatusRate = 60.0;        // [Hz]
  static constexpr double kCursorRate = 125.0;       // at most [Hz]
  static constexpr std::uint32_t kMostFrameBytes = 64u << 10;

  // Both must outlive the desk.
  PageDesk(PageSink& pages, MasterOrders& master, PageDeskOptions options);
  // Of a recording: no order of any page passes, and none leads. Whoever may do more than look
  // plays, pauses and seeks, for all alike.
  PageDesk(PageSink& pages, PlayedRecording recording, PageDeskOptions options);

  // `observes`: it may look, and no order of it passes, not even a stop.
  void opened(PageId page, bool observes, Nanos now);
  void received(PageId page, std::string_view text, Nanos now);
  void closed(PageId page, Nanos now);

  // What the question of `asked` brought.
  void status(const Result<pb::Reply>& reply, Nanos asked, Nanos now);
  // Where the player stands: the next status is of that moment.
  void played(const PlayState& state) { play_ = state; }
  // What is told of the simulated rig from the next status on.
  void rig(const pb::RigNews& news) { rig_ = news; }
  void scene(const pb::SceneNews& news);
  void answered(std::uint64_t ticket, const Result<pb::Reply>& reply, Nanos now);
  void pointed(const Result<pb::Reply>& reply);

  std::size_t pages() const noexcept { return pages_.size(); }
  PageId leader() const noexcept { return leader_; }

 private:
  struct Page {
    bool observes = false;
    std::uint32_t waiting = 0;                   // requests
    std::optional<pb::CursorOrder> cursor = {};  // its newest
    int frames = 0;                              // in this second
    Nanos second = 0;                            // when that began
  };
  struct Ticket {
    PageId page;
    std::uint32_t id;
    bool leads = false;  // a lead: refused by the master, the page does not lead
    bool stops = false;
  };

  // Why no order of that page passes, whatever it is; empty: some do.
  std::string only_looks(const Page& page) const;
  void request(PageId page, const pb::PageRequest& request);
  // Why that order does not pass; empty: it does.
  std::string refusal(PageId page, const pb::Request& order, const Page& from) const;
  void hand(PageId page, pb::CursorOrder cursor);
  void lead(PageId page, const pb::PageLead& lead, Nanos now);
  void play(PageId page, const pb::PagePlay& wanted);
  void set_leader(PageId page, Nanos now);
  void order(Ticket ticket, pb::Request request);
  void let_go();
  void withdraw_all(PageId page);
  void reply(PageId page, std::uint32_t id, bool done, const std::string& reason);
  void greet(PageId page, Nanos now);
  void tell(PageId page, const pb::ToPage& frame);

  PageSink& sink_;
  MasterOrders* const master_;  // null: a recording is shown
  const PlayedRecording recording_;
  const PageDeskOptions options_;
  PlayState play_;
  std::optional<pb::RigNews> rig_;  // none: no rig is known
  std::map<PageId, Page> pages_;
  std::map<std::uint64_t, Ticket> tickets_;
  std::uint64_t next_ticket_ = 1;
  PageId leader_ = 0;
  Nanos led_since_ = 0;
  std::uint64_t cursor_number_ = 0;  // of ours to the master
  std::optional<bool> taken_;        // what the leader was told of its cursor
  SharedText scene_;                 // the newest, for pages that come
  std::uint64_t statuses_ = 0;
  Nanos good_ = -1;  // when the newest status came; -1: none yet
};

}  // namespace handrail
