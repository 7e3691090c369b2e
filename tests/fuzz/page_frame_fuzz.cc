// Frames of pages, as browsers or strangers with a session might send them, to the desk and to a
// master that answers late or never. A line of the input is an act: its first letter says which,
// the rest is a frame's text.
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "client/console/gateway/json_text.h"
#include "client/console/gateway/page_desk.h"
#include "server/base/plain_text.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

constexpr std::size_t kSlots = 3;  // the last is an observer's

// The desk, its pages and its master.
class DrivenDesk : public PageSink, public MasterOrders {
 public:
  DrivenDesk() {
    for (std::size_t slot = 0; slot < kSlots; ++slot) open(slot);
  }
  void send(PageId page, SharedText text, bool, FrameWorth) override {
    pb::ToPage frame;
    const bool has_reply = text->find("\"reply\":{") != std::string::npos;
    require(pages_.contains(page), "who is gone is told nothing");
    require(text->front() == '{' && text->back() == '}', "a frame is JSON");
    if (has_reply && text->starts_with("{\"reply\"")) ++pages_[page].replies;
  }
  void end(PageId page, std::uint16_t code, const std::string& why) override {
    require(code == 1008 && is_plain_text(why) && !why.empty(), "an end says why, in plain text");
    ending_.insert(page);
  }
  void order(std::uint64_t ticket, const pb::Request& request) override {
    require(!observes(speaker_), "no order of an observer passes");
    require(!request.has_as(), "nobody speaks in another's name");
    require(request.has_stop() || request.has_lease() || desk_.leader() == speaker_,
            "orders are the leader's");
    require(waiting_.insert(ticket).second, "a ticket is new");
  }
  void withdraw(std::uint64_t ticket) override {
    require(waiting_.contains(ticket), "what is withdrawn waits");
  }
  void point(const pb::CursorOrder& cursor) override {
    require(cursor.sequence() > cursor_, "cursors come in order");
    require(!observes(speaker_) || !cursor.held(), "an observer holds nothing");
    cursor_ = cursor.sequence();
  }

  void act(std::string_view line) {
    now_ += 20 * kMillisecond;
    const char what = line.front();
    if (what >= '1' && what <= '3') {
      return say(slots_[static_cast<std::size_t>(what - '1')], line.substr(1));
    }
    if (what == 'y' || what == 'n') return answer(what == 'y');
    if (what == 'c') return close(slots_[line.size() % kSlots]);
    if (what == 'o') return open(line.size() % kSlots);
    if (what == 'p') return point_answer();
  }
  void answer_all() {
    while (!waiting_.empty()) answer(true);
    for (const auto& [page, state] : pages_) {
      require(state.asked == state.replies, "every request and every lead is answered once");
    }
  }

 private:
  struct Page {
    int asked = 0, replies = 0;
  };

  bool observes(PageId page) const { return page != 0 && page == slots_[kSlots - 1]; }
  // Numbers of pages are never used again.
  void open(std::size_t slot) {
    if (pages_.contains(slots_[slot])) return;
    const PageId page = slots_[slot] = ++newest_;
    pages_[page] = {};
    desk_.opened(page, observes(page), now_);
  }
  void close(PageId page) {
    if (!pages_.contains(page)) return;
    desk_.closed(page, now_);
    pages_.erase(page);
    require(desk_.leader() != page, "who is gone leads no more");
  }
  void say(PageId page, std::string_view text) {
    if (!pages_.contains(page)) return;
    const auto frame = page_frame(text);
    if (frame && !frame->has_hand()) ++pages_[page].asked;
    if (frame) {
      const auto again = page_frame(json_text(*frame));
      require(again && again->SerializeAsString() == frame->SerializeAsString(),
              "what was understood is written and read as the same");
    }
    speaker_ = page;
    desk_.received(page, text, now_);
    require(frame || ending_.contains(page), "what is not understood ends its page");
    // More than 500 a second are not answered: then it ends, too.
    for (const PageId each : std::exchange(ending_, {})) close(each);
    speaker_ = 0;
  }
  void answer(bool done) {
    if (waiting_.empty()) return;
    const std::uint64_t ticket = *waiting_.begin();
    waiting_.erase(waiting_.begin());
    pb::Reply reply;
    reply.set_done(done);
    if (!done) reply.set_reason("not now");
    desk_.answered(ticket, reply, now_);
  }
  void point_answer() {
    pb::Reply reply;
    reply.set_done(now_ / kMillisecond % 40 == 0);
    desk_.pointed(reply);
  }

  std::array<PageId, kSlots> slots_{};
  PageId newest_ = 0;
  std::map<PageId, Page> pages_;
  std::set<PageId> ending_;
  std::set<std::uint64_t> waiting_;
  std::uint64_t cursor_ = 0;
  PageId speaker_ = 0;
  Nanos now_ = kSecond;
  PageDesk desk_{*this, *this, {false, "1", "console", "/run/op.sock"}};
};

}  // namespace

HANDRAIL_FUZZ(page_frame) {
  const google::protobuf::LogSilencer silence;  // it writes of names that are no UTF-8
  std::string_view left = fuzz::text_of(bytes);
  if (const auto frame = page_frame(left); !frame) {
    require(is_plain_text(frame.message()), "a refusal is one line of plain text");
    require(frame.message().find('\n') == std::string::npos, "a refusal is one line");
  }
  DrivenDesk desk;
  for (std::size_t acts = fuzz::most_acts(bytes.size()); acts > 0 && !left.empty(); --acts) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    if (end > 0) desk.act(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  desk.answer_all();
}

}  // namespace handrail
