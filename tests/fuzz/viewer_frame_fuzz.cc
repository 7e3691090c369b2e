// Frames of viewers, as Foxglove or strangers with the viewers' secret might send them, to the desk
// while statuses and scenes come. A line of the input is an act: its first letter says which, the
// rest is a frame.
#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/json_util.h>

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "client/console/viewer/viewer_desk.h"
#include "server/base/plain_text.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

constexpr std::size_t kViewerSlots = 2;
constexpr std::uint32_t kLastChannel = static_cast<std::uint32_t>(ViewerDesk::Channel::kCount);

// The desk and its viewers, which keep by themselves what they look at.
class DrivenViewers : public PageSink {
 public:
  DrivenViewers() {
    for (std::size_t slot = 0; slot < kViewerSlots; ++slot) open(slot);
    reply_.set_done(true);
    reply_.mutable_status()->set_state("off");
  }

  void send(PageId viewer, SharedText frame, bool binary, FrameWorth worth) override {
    require(viewers_.contains(viewer), "who is gone is told nothing");
    if (!binary) return tell(viewer, *frame, worth);
    require(frame->size() >= 13 && frame->front() == 1, "data begins with its opcode and its head");
    require(worth.slot >= 0, "data that is not read makes nothing else wait");
    std::uint32_t id = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      id |= static_cast<std::uint32_t>(static_cast<unsigned char>((*frame)[1 + i])) << (8 * i);
    }
    const auto look = viewers_[viewer].looks.find(id);
    require(look != viewers_[viewer].looks.end(), "data is for what was subscribed");
    viewers_[viewer].had += look->second == kLastChannel;
  }
  void end(PageId viewer, std::uint16_t code, const std::string& why) override {
    require(code == 1008 && is_plain_text(why) && !why.empty(), "an end says why, in plain text");
    ending_.insert(viewer);
  }

  void act(std::string_view line) {
    at_.now += 5 * kMillisecond;
    at_.calendar += 5 * kMillisecond;
    const char what = line.front();
    const std::size_t slot = line.size() % kViewerSlots;
    if (what == '1' || what == '2') {
      return say(slots_[static_cast<std::size_t>(what - '1')], line.substr(1), false);
    }
    if (what == 'b') return say(slots_[slot], line.substr(1), true);
    if (what == 's') return status();
    if (what == 'g') return desk_.status(Status::error("no master"), at_.calendar);
    if (what == 'm') return scene(line.size());
    if (what == 'c') return close(slots_[slot]);
    if (what == 'o') return open(slot);
  }

 private:
  struct Viewer {
    std::map<std::uint32_t, std::uint32_t> looks = {};  // subscription to channel
    int told = 0;                                       // texts
    int had = 0;                                        // data of /status
  };

  void tell(PageId viewer, const std::string& text, const FrameWorth& worth) {
    require(worth.slot < 0, "what is said is not left out");
    ++viewers_[viewer].told;
    if (!text.starts_with("{\"op\":\"status\"")) return;
    pb::ViewerStatus status;
    const auto read = google::protobuf::util::JsonStringToMessage(text, &status);
    require(read.ok() && is_plain_text(status.message()), "an answer is JSON, in plain text");
  }
  void open(std::size_t slot) {
    if (viewers_.contains(slots_[slot])) return;
    const PageId viewer = slots_[slot] = ++newest_;
    viewers_[viewer] = {};
    desk_.opened(viewer, at_.now);
    require(viewers_[viewer].told == 2, "who comes is told who this is and what there is");
  }
  void close(PageId viewer) {
    if (!viewers_.contains(viewer)) return;
    desk_.closed(viewer);
    viewers_.erase(viewer);
  }
  // What of these may be, by the rules of the protocol; how many may not.
  static int expect(Viewer& viewer, const pb::FromViewer& said) {
    int wrong = 0;
    if (said.op() == "subscribe") {
      for (const auto& asked : said.subscriptions()) {
        const std::uint32_t channel = asked.channel_id();
        bool may = asked.has_id() && channel >= 1 && channel <= kLastChannel;
        for (const auto& [id, its] : viewer.looks) may = may && id != asked.id() && its != channel;
        if (may) viewer.looks[asked.id()] = channel;
        wrong += !may;
      }
    } else if (said.op() == "unsubscribe") {
      for (const std::uint32_t id : said.subscription_ids()) wrong += viewer.looks.erase(id) == 0;
    } else {
      return 1;
    }
    return wrong;
  }
  void say(PageId viewer, std::string_view text, bool binary) {
    if (!viewers_.contains(viewer)) return;
    Viewer& of = viewers_[viewer];
    const auto said = viewer_frame(text);
    const Viewer before = of;
    // Data of what is subscribed comes in the same call.
    const int wrong = binary || !said ? 1 : expect(of, *said);
    desk_.received(viewer, text, binary, at_);
    if (ending_.contains(viewer)) of.looks = before.looks;
    require(ending_.contains(viewer) || of.told - before.told == wrong,
            "whatever is wrong is answered once, and nothing else");
    for (const PageId each : std::exchange(ending_, {})) close(each);
  }
  void status() {
    for (auto& [viewer, state] : viewers_) state.had = 0;
    reply_.mutable_status()->set_ticks(reply_.status().ticks() + 1);
    desk_.status(reply_, at_.calendar);
    for (const auto& [viewer, state] : viewers_) {
      int looks = 0;
      for (const auto& [id, channel] : state.looks) looks += channel == kLastChannel;
      require(state.had == looks, "each status comes once where it is subscribed");
    }
  }
  void scene(std::size_t size) {
    pb::SceneNews news;
    news.set_number(std::to_string(size));
    MapCells cells;
    if (size % 2 == 0) cells = {2, 1, {0.1, 0.1}, "rgbRGB"};
    desk_.scene(news, cells, at_.calendar);
  }

  std::array<PageId, kViewerSlots> slots_{};
  PageId newest_ = 0;
  std::map<PageId, Viewer> viewers_;
  std::set<PageId> ending_;
  Moment at_{kSecond, 1'700'000'000 * kSecond};
  pb::Reply reply_;
  ViewerDesk desk_{*this, "1", "2"};
};

}  // namespace

HANDRAIL_FUZZ(viewer_frame) {
  const google::protobuf::LogSilencer silence;  // it writes of names that are no UTF-8
  std::string_view left = fuzz::text_of(bytes);
  if (const auto frame = viewer_frame(left); !frame) {
    require(is_plain_text(frame.message()), "a refusal is one line of plain text");
    require(frame.message().find('\n') == std::string::npos, "a refusal is one line");
  }
  DrivenViewers driven;
  for (std::size_t acts = fuzz::most_acts(bytes.size()); acts > 0 && !left.empty(); --acts) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    if (end > 0) driven.act(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
}

}  // namespace handrail
