#include "client/console/gateway/page_desk.h"

#include <cmath>
#include <utility>

#include "client/console/gateway/json_text.h"

namespace handrail {
namespace {

// Frames of which only the newest counts.
constexpr FrameWorth kStatusFrame{0};
constexpr FrameWorth kSceneFrame{1};
constexpr FrameWorth kHelloFrame{2};

constexpr std::uint16_t kPolicy = 1008;  // RFC 6455: a frame that is not to be

double milliseconds(Nanos time) { return to_seconds(time) * 1e3; }

constexpr char kConsoleLooks[] = "this console only looks: it was started with --observe";
constexpr char kRecordingLooks[] =
    "this is a recording: no order can be given, and nothing is stopped by it";
constexpr char kPageLooks[] =
    "this page only looks: it was opened by an observer's link (`handrail keys link operator` "
    "makes "
    "one to drive with)";

}  // namespace

PageDesk::PageDesk(PageSink& pages, MasterOrders& master, PageDeskOptions options)
    : sink_(pages), master_(&master), options_(std::move(options)) {}

PageDesk::PageDesk(PageSink& pages, PlayedRecording recording, PageDeskOptions options)
    : sink_(pages),
      master_(nullptr),
      recording_(std::move(recording)),
      options_(std::move(options)) {}

void PageDesk::opened(PageId page, bool observes, Nanos now) {
  pages_[page].observes = observes;
  pages_[page].second = now;
  greet(page, now);
  if (scene_) sink_.send(page, scene_, false, kSceneFrame);
}

void PageDesk::greet(PageId page, Nanos now) {
  pb::ToPage frame;
  pb::Hello& hello = *frame.mutable_hello();
  hello.set_version(options_.version);
  hello.set_role(only_looks(pages_[page]).empty() ? pb::Hello::OPERATOR : pb::Hello::OBSERVER);
  hello.set_page(page);
  hello.set_leader(leader_);
  if (leader_ != 0) {
    hello.set_leader_text("page " + std::to_string(leader_) + ", for " +
                          std::to_string((now - led_since_) / kSecond) + " s");
  }
  hello.set_name(options_.name);
  hello.set_master(options_.master);
  for (const std::string& scene : options_.scenes) hello.add_scene(scene);
  if (master_ == nullptr) *hello.mutable_recording() = recording_.news;
  pb::ConsoleLimits& limits = *hello.mutable_limits();
  limits.set_status_hz(kStatusRate);
  limits.set_hand_hz_most(kCursorRate);
  limits.set_hand_patience_ms(200);
  limits.set_frame_bytes_most(kMostFrameBytes);
  limits.set_requests_most(kMostRequests);
  limits.set_pages_most(kMostPages);
  sink_.send(page, shared_text(json_text(frame)), false, kHelloFrame);
}

void PageDesk::tell(PageId page, const pb::ToPage& frame) {
  sink_.send(page, shared_text(json_text(frame)), false, {});
}

void PageDesk::reply(PageId page, std::uint32_t id, bool done, const std::string& reason) {
  pb::ToPage frame;
  frame.mutable_reply()->set_id(id);
  frame.mutable_reply()->set_done(done);
  if (!reason.empty()) frame.mutable_reply()->set_reason(reason);
  tell(page, frame);
}

void PageDesk::received(PageId page, std::string_view text, Nanos now) {
  const auto from = pages_.find(page);
  if (from == pages_.end()) return;
  Page& of = from->second;
  if (now - of.second >= kSecond) {
    of.second = now;
    of.frames = 0;
  }
  if (++of.frames > kMostFrames) {
    return sink_.end(page, kPolicy,
                     "more than " + std::to_string(kMostFrames) + " frames in a second");
  }
  const auto frame = page_frame(text);
  if (!frame) return sink_.end(page, kPolicy, frame.message());
  switch (frame->frame_case()) {
    case pb::FromPage::kRequest: return request(page, frame->request());
    case pb::FromPage::kHand: return hand(page, frame->hand());
    case pb::FromPage::kLead: return lead(page, frame->lead(), now);
    case pb::FromPage::kPlay: return play(page, frame->play());
    case pb::FromPage::FRAME_NOT_SET: break;
  }
}

std::string PageDesk::only_looks(const Page& page) const {
  if (master_ == nullptr) return kRecordingLooks;
  return options_.observe ? kConsoleLooks : page.observes ? kPageLooks : "";
}

std::string PageDesk::refusal(PageId page, const pb::Request& order, const Page& from) const {
  if (std::string looks = only_looks(from); !looks.empty()) return looks;
  if (order.has_as()) return "as: the gateway speaks in its own name: leave it out";
  switch (order.order_case()) {
    case pb::Request::ORDER_NOT_SET: return "the request holds no order";
    case pb::Request::kStatus: return "a status comes by itself, 60 times a second";
    case pb::Request::kCursor: return "a cursor is sent as `hand`";
    case pb::Request::kStop: return {};
    default: break;
  }
  if (leader_ != page) {
    return leader_ == 0 ? "no page leads: send `lead` first"
                        : "page " + std::to_string(leader_) +
                              " leads: send `lead` with act TAKE_OVER to drive from this one";
  }
  if (from.waiting >= kMostRequests) {
    return std::to_string(kMostRequests) + " requests of this page wait for their reply";
  }
  return {};
}

void PageDesk::request(PageId page, const pb::PageRequest& request) {
  const std::string why = refusal(page, request.order(), pages_[page]);
  if (!why.empty()) return reply(page, request.id(), false, why);
  order({page, request.id(), false, request.order().has_stop()}, request.order());
}

void PageDesk::order(Ticket ticket, pb::Request request) {
  const std::uint64_t number = next_ticket_++;
  if (!ticket.stops) ++pages_[ticket.page].waiting;
  tickets_.emplace(number, ticket);
  master_->order(number, request);
}

void PageDesk::answered(std::uint64_t number, const Result<pb::Reply>& result, Nanos now) {
  const auto found = tickets_.find(number);
  if (found == tickets_.end()) return;
  const Ticket ticket = found->second;
  tickets_.erase(found);
  const bool done = result && result->done();
  if (ticket.leads && !done && leader_ == ticket.page) set_leader(0, now);
  const auto page = pages_.find(ticket.page);
  if (page == pages_.end()) return;
  if (!ticket.stops) --page->second.waiting;
  pb::ToPage frame;
  pb::PageReply& out = *frame.mutable_reply();
  out.set_id(ticket.id);
  out.set_done(done);
  const std::string& reason = result ? result->reason() : result.message();
  if (!reason.empty()) out.set_reason(reason);
  if (result && result->has_lease()) *out.mutable_lease() = result->lease();
  tell(ticket.page, frame);
}

void PageDesk::lead(PageId page, const pb::PageLead& lead, Nanos now) {
  if (const std::string looks = only_looks(pages_[page]); !looks.empty()) {
    return reply(page, lead.id(), false, looks);
  }
  const bool others = leader_ != 0 && leader_ != page;
  pb::Request request;
  switch (lead.act()) {
    case pb::PageLead::TAKE:
      if (others) {
        return reply(page, lead.id(), false,
                     "page " + std::to_string(leader_) + " leads, for " +
                         std::to_string((now - led_since_) / kSecond) +
                         " s: send act TAKE_OVER to drive from this one");
      }
      break;
    case pb::PageLead::TAKE_OVER: break;
    case pb::PageLead::RELEASE:
      if (leader_ != page) return reply(page, lead.id(), false, "this page does not lead");
      set_leader(0, now);
      request.mutable_lease()->set_act(pb::LeaseOrder::RELEASE);
      return order({page, lead.id()}, request);
  }
  if (leader_ != page) set_leader(page, now);
  request.mutable_lease()->set_act(pb::LeaseOrder::TAKE);
  order({page, lead.id(), true}, request);
}

void PageDesk::set_leader(PageId page, Nanos now) {
  if (leader_ != 0) {
    let_go();
    withdraw_all(leader_);
  }
  leader_ = page;
  led_since_ = now;
  taken_.reset();
  for (const auto& [each, state] : pages_) greet(each, now);
}

// The hand that the leader has led does not wait for 200 ms.
void PageDesk::let_go() {
  const auto page = pages_.find(leader_);
  if (page == pages_.end() || !page->second.cursor) return;
  pb::CursorOrder gone = *std::exchange(page->second.cursor, std::nullopt);
  gone.set_sequence(++cursor_number_);
  gone.set_held(false);
  gone.set_clutch(false);
  master_->point(gone);
}

void PageDesk::withdraw_all(PageId page) {
  for (const auto& [number, ticket] : tickets_) {
    if (ticket.page == page && !ticket.stops) master_->withdraw(number);
  }
}

void PageDesk::closed(PageId page, Nanos now) {
  if (!pages_.contains(page)) return;
  if (leader_ == page) {
    let_go();
    withdraw_all(page);
    pages_.erase(page);
    return set_leader(0, now);
  }
  withdraw_all(page);
  pages_.erase(page);
}

void PageDesk::hand(PageId page, pb::CursorOrder cursor) {
  Page& from = pages_[page];
  if (leader_ != page || !only_looks(from).empty()) return;
  // Frames of one page come in order, so that only the same one again is left out.
  if (from.cursor && cursor.sequence() == from.cursor->sequence()) return;
  from.cursor = cursor;
  cursor.set_sequence(++cursor_number_);
  master_->point(cursor);
}

void PageDesk::play(PageId page, const pb::PagePlay& wanted) {
  if (recording_.orders == nullptr) {
    return reply(page, wanted.id(), false,
                 "play: this is no recording: expected request, hand or lead");
  }
  if (pages_[page].observes) return reply(page, wanted.id(), false, kPageLooks);
  PlayOrder order;
  if (wanted.has_playing()) order.playing = wanted.playing();
  if (wanted.has_speed()) order.speed = wanted.speed();
  if (wanted.has_position_s()) {
    constexpr double kFarthest = 1e9;  // [s], 30 years: what fits Nanos
    const double at = wanted.position_s();
    if (!(std::abs(at) <= kFarthest)) {
      return reply(page, wanted.id(), false,
                   "position_s: " + std::to_string(at) + ", expected seconds of the recording");
    }
    order.position = static_cast<Nanos>(std::llround(at * 1e9));
  }
  const auto state = recording_.orders->play(order);
  reply(page, wanted.id(), state.is_ok(), state.message());
}

void PageDesk::pointed(const Result<pb::Reply>& result) {
  const bool taken = result && result->done();
  if (leader_ == 0 || taken_ == taken) return;
  taken_ = taken;
  pb::ToPage frame;
  frame.mutable_hand()->set_taken(taken);
  if (!taken) frame.mutable_hand()->set_reason(result ? result->reason() : result.message());
  tell(leader_, frame);
}

void PageDesk::status(const Result<pb::Reply>& result, Nanos asked, Nanos now) {
  ++statuses_;
  pb::ToPage frame;
  pb::StatusNews& news = *frame.mutable_status();
  if (result && result->has_status()) {
    *news.mutable_status() = result->status();
    news.set_round_trip_ms(milliseconds(now - asked));
    good_ = now;
  } else {
    news.set_problem(result ? result->reason() : result.message());
  }
  if (pages_.empty()) return;
  if (good_ >= 0) news.set_age_ms(milliseconds(now - good_));
  news.set_gateway_s(to_seconds(now));
  news.set_number(statuses_);
  news.set_pages(static_cast<std::uint32_t>(pages_.size()));
  if (rig_) *news.mutable_rig() = *rig_;
  if (master_ == nullptr) {
    pb::PlayNews& play = *news.mutable_play();
    play.set_state(static_cast<pb::PlayNews::State>(play_.is));
    play.set_position_s(to_seconds(play_.position));
    play.set_speed(play_.speed);
    play.set_jumps(play_.jumps);
  }
  const SharedText text = shared_text(json_text(frame));
  for (const auto& [page, state] : pages_) sink_.send(page, text, false, kStatusFrame);
}

void PageDesk::scene(const pb::SceneNews& news) {
  pb::ToPage frame;
  *frame.mutable_scene() = news;
  scene_ = shared_text(json_text(frame));
  for (const auto& [page, state] : pages_) sink_.send(page, scene_, false, kSceneFrame);
}

}  // namespace handrail
