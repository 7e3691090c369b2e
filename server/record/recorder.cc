#include "server/record/recorder.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/signals.h"
#include "server/record/record_folder.h"
#include "server/record/recording_sink.h"

namespace handrail {
namespace {

// A tap holds a second of ticks; a chunk must be on the disk 100 ms after its first tick.
constexpr auto kPull = std::chrono::milliseconds(20);
constexpr Nanos kChunk = 60 * kMillisecond;
// The scenes that ticks of the last half minute can name: the loop takes at most a few a second.
constexpr std::size_t kMostScenes = 32;
constexpr Nanos kPrunePeriod = 10 * kSecond;
// Of a chunk, of 60 ms or of what has come meanwhile: a tap has room for twice as much.
constexpr Nanos kSlowDisk = 500 * kMillisecond;

}  // namespace

// Its thread's own, but for what stands behind the lock.
class Recorder::Thread final : public RecordSink {
 public:
  Thread(RecorderOptions options, std::unique_ptr<RecordFeed> feed, pb::RecordedStart start)
      : options_(std::move(options)),
        feed_(std::move(feed)),
        start_(std::move(start)),
        layout_(record_layout()) {
    start_.set_build(record_build());
    start_.set_monotonic_ns(monotonic_now());
    start_.set_calendar_ns(calendar_now());
    since_ = start_.calendar_ns() - start_.monotonic_ns();
    const SignalsBlocked blocked;
    thread_ = std::thread([this] { run(); });
  }
  ~Thread() override {
    ask_to_end();
    thread_.join();
  }
  bool end(Nanos patience) {
    ask_to_end();
    std::unique_lock lock(mutex_);
    const bool ended =
        ended_now_.wait_for(lock, std::chrono::nanoseconds(patience), [this] { return ended_; });
    lock.unlock();
    if (!ended) say(true, "the disk does not answer: the recording's end is not written");
    return ended;
  }

  template <typename F>
  void leave(F f) {
    const std::lock_guard lock(mutex_);
    f(word_);
  }
  RecorderState state() const {
    const std::lock_guard lock(mutex_);
    RecorderState out = state_;
    const Nanos since = writing_since_.load(std::memory_order_relaxed);
    if (since < 0 || !out.problem.empty()) return out;
    if (const Nanos takes = monotonic_now() - since; takes > kSlowDisk) out.problem = slow(takes);
    return out;
  }

  const std::string& folder() const noexcept { return options_.folder; }
  bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }

  struct Word {
    std::vector<pb::RecordedScene> scenes;
    std::vector<pb::RecordedEvent> marks;
    std::optional<std::string> start;  // its label
    bool stop = false;
  };

 private:
  struct KeptChunk {
    McapChunk chunk;
    bool beginning = false;  // it begins with an image
  };

  void ask_to_end() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.notify_one();
  }

  void run() {
    std::unique_lock lock(mutex_);
    for (bool last = false; !last;) {
      wake_.wait_for(lock, kPull, [this] { return ends_; });
      last = ends_;
      const Word word = std::exchange(word_, {});
      lock.unlock();
      try {
        work(word, last);
      } catch (const std::exception& refused) {
        give_up(refused);
      }
      lock.lock();
      state_.file = file_ ? file_->path() : "";
      state_.bytes = file_ ? file_->size() : 0;
      state_.problem = problem_;
      state_.lost = feed_->lost();
      asked_.store(file_ && !automatic_, std::memory_order_relaxed);
    }
    ended_ = true;
    ended_now_.notify_all();
  }

  void work(const Word& word, bool last) {
    for (const pb::RecordedScene& scene : word.scenes) add_scene(scene);
    feed_->pull(*this);
    for (const pb::RecordedEvent& mark : word.marks) put_event(mark);
    const Nanos now = monotonic_now();
    if (word.start) begin_asked(*word.start, "asked for");
    if (!building_.empty() && (last || now - building_since_ >= kChunk)) close_chunk();
    if (file_ && file_->removed()) begin_again();
    if (file_ && (word.stop || last || (until_ != kForever && now >= until_))) close_file();
    if (now >= next_prune_ && file_) prune_now(now);
  }

  // What was not written is gone, and the daemon goes on: a replay finds that ticks are missing.
  void give_up(const std::exception& why) noexcept {
    building_ = McapChunkBuilder();
    begins_ = false;
    ring_.clear();
    if (std::exchange(said_refused_, true)) return;
    try {
      say(true, std::string("the recording has a gap: ") + why.what());
    } catch (const std::exception&) {  // no memory to say so
    }
  }

  // What was removed is gone. What somebody asked for goes on in another file.
  void begin_again() {
    say(true, file_->path() + " was removed while it was written");
    file_.reset();
    if (!automatic_) open(label_, "the one before was removed", false);
  }

  // A file that was begun for a stop or a fault ends for one that somebody asks for.
  void begin_asked(const std::string& label, const char* why) {
    if (file_ && automatic_) close_file();
    if (!file_) open(label, why, false);
  }

  // RecordSink
  void message(RecordChannel channel, Nanos at, std::string_view bytes) override {
    if (building_.empty()) building_since_ = monotonic_now();
    const auto time = static_cast<std::uint64_t>(std::max<Nanos>(at + since_, 0));
    building_.add({static_cast<std::uint16_t>(channel), ++sequence_, time, time, bytes});
  }
  void beginning() override {
    if (!building_.empty()) close_chunk();
    begins_ = true;
  }
  void happened(pb::RecordedEvent::Kind kind, Nanos at, const std::string& text) override {
    pb::RecordedEvent event;
    event.set_at_ns(at);
    event.set_kind(kind);
    event.set_text(text);
    put_event(event);
    if (!file_) open(kind == pb::RecordedEvent::STOP ? "stop" : "fault", text, true);
    if (automatic_) until_ = monotonic_now() + options_.after;
  }
  Nanos calendar(Nanos at) const override { return at + since_; }
  void wanted(bool recording) override {
    if (recording == std::exchange(wanted_, recording)) return;
    if (recording) begin_asked("", "the master records");
    if (!recording && file_ && !automatic_) until_ = monotonic_now();
  }

  void put_event(const pb::RecordedEvent& event) {
    message(RecordChannel::kEvent, event.at_ns(), event.SerializeAsString());
  }
  void add_scene(const pb::RecordedScene& scene) {
    if (scenes_.size() == kMostScenes) scenes_.pop_front();
    scenes_.push_back(scene);
    message(RecordChannel::kScene, monotonic_now(), scene.SerializeAsString());
  }

  void close_chunk() {
    KeptChunk kept{building_.close(), std::exchange(begins_, false)};
    if (file_) write(kept.chunk);
    ring_.push_back(std::move(kept));
    // As far back as is kept there must be an image to begin with.
    const std::uint64_t newest = ring_.back().chunk.last;
    const auto before = static_cast<std::uint64_t>(options_.before);
    std::size_t first = 0;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      if (ring_[i].beginning && newest - std::min(newest, ring_[i].chunk.first) >= before)
        first = i;
    }
    ring_.erase(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(first));
    // Without an image for so long nothing of it could be done again.
    const std::uint64_t most = before + 2 * static_cast<std::uint64_t>(kImagePeriod);
    while (ring_.size() > 1 && newest - std::min(newest, ring_.front().chunk.first) > most)
      ring_.pop_front();
  }

  void write(const McapChunk& chunk) {
    const Nanos since = monotonic_now();
    writing_since_.store(since, std::memory_order_relaxed);
    Status done = file_->write(chunk);
    writing_since_.store(-1, std::memory_order_relaxed);
    if (const Nanos took = monotonic_now() - since; done && took > kSlowDisk) {
      if (!std::exchange(is_slow_, true)) say(true, slow(took));
    } else {
      is_slow_ = false;
    }
    if (done && gap_) {
      pb::RecordedEvent event;
      event.set_at_ns(monotonic_now());
      event.set_kind(pb::RecordedEvent::DISK);
      event.set_text(problem_);
      event.set_count(std::exchange(gap_, 0));
      put_event(event);
      say(false, "the disk takes the recording again");
    }
    if (done) {
      problem_.clear();
      return;
    }
    if (gap_++ == 0) say(true, "the recording has a gap: " + done.message());
    problem_ = done.message();
  }

  static std::string slow(Nanos takes) {
    return "the disk takes " + std::to_string(takes / kMillisecond) +
           " ms to write what comes in less; what there is no room for is lost";
  }

  // With all that is kept of what came before.
  void open(const std::string& label, const std::string& why, bool automatic) {
    if (!building_.empty()) close_chunk();
    std::error_code error;
    std::filesystem::create_directories(options_.folder, error);
    const std::string path =
        options_.folder + "/" + recording_name(calendar_now(), feed_->side(), label);
    auto made = RecordingSink::make(path, layout_);
    if (!made) {
      if (problem_ != made.message()) say(true, "no recording: " + made.message());
      problem_ = made.message();
      return;
    }
    file_.emplace(std::move(*made));
    automatic_ = automatic;
    label_ = label;
    until_ = automatic ? monotonic_now() + options_.after : kForever;
    problem_.clear();
    gap_ = 0;
    next_prune_ = 0;
    say(false, "recording " + path + ": " + why);
    write(head(why));
    // What was asked for begins now; a stop or a fault has what led to it.
    const std::size_t last = newest_beginning();
    for (std::size_t i = automatic ? 0 : last; i < ring_.size(); ++i) write(ring_[i].chunk);
  }

  std::size_t newest_beginning() const {
    for (std::size_t i = ring_.size(); i-- > 0;) {
      if (ring_[i].beginning) return i;
    }
    return 0;
  }

  // What every file begins with.
  McapChunk head(const std::string& why) {
    pb::RecordedStart start = start_;
    start.set_why(why);
    McapChunkBuilder out;
    const auto time = static_cast<std::uint64_t>(std::max<Nanos>(
        ring_.empty() ? calendar_now() : static_cast<Nanos>(ring_.front().chunk.first), 0));
    const auto add = [&](RecordChannel channel, const std::string& bytes) {
      out.add({static_cast<std::uint16_t>(channel), ++sequence_, time, time, bytes});
    };
    add(RecordChannel::kStart, start.SerializeAsString());
    for (const pb::RecordedScene& scene : scenes_) {
      add(RecordChannel::kScene, scene.SerializeAsString());
    }
    return out.close();
  }

  void close_file() {
    if (!building_.empty()) close_chunk();
    if (Status done = file_->finish(); !done) {
      say(true, "the recording's end: " + done.message());
    } else {
      say(false, "recorded " + file_->path() + ", " + std::to_string(file_->size() / 1000) + " kB");
    }
    file_.reset();
    prune_now(monotonic_now());
  }

  void prune_now(Nanos now) {
    next_prune_ = now + kPrunePeriod;
    const auto gone = prune(options_.folder, feed_->side(), options_.keep_bytes,
                            calendar_now() - options_.keep_for, file_ ? file_->path() : "");
    for (const std::string& path : gone) say(false, "removed the oldest recording, " + path);
    if (!file_ || file_->size() < options_.keep_bytes) return;
    say(true, "the recording is as long as all may be together and ends here");
    close_file();
  }

  void say(bool bad, const std::string& line) const {
    if (options_.say) options_.say(bad, line);
  }

  const RecorderOptions options_;
  const std::unique_ptr<RecordFeed> feed_;
  pb::RecordedStart start_;
  const McapLayout layout_;
  Nanos since_ = 0;  // from the monotonic clock to the calendar
  std::uint32_t sequence_ = 0;
  std::deque<pb::RecordedScene> scenes_;
  McapChunkBuilder building_;
  Nanos building_since_ = 0;
  bool begins_ = false;  // the chunk that is built begins with an image
  std::deque<KeptChunk> ring_;
  std::optional<RecordingSink> file_;
  bool automatic_ = false;
  std::string label_;
  bool is_slow_ = false;
  bool wanted_ = false;
  Nanos until_ = kForever;
  Nanos next_prune_ = 0;
  std::string problem_;
  bool said_refused_ = false;
  std::uint64_t gap_ = 0;  // chunks that the disk did not take

  std::atomic<Nanos> writing_since_{-1};  // -1: the disk is not asked for anything

  mutable std::mutex mutex_;
  std::condition_variable wake_, ended_now_;
  Word word_;
  RecorderState state_;
  bool ends_ = false, ended_ = false;
  std::atomic<bool> asked_{false};
  std::thread thread_;  // last: it uses the others
};

Recorder::Recorder(RecorderOptions options, std::unique_ptr<RecordFeed> feed,
                   pb::RecordedStart start)
    : thread_(std::make_unique<Thread>(std::move(options), std::move(feed), std::move(start))) {}
Recorder::~Recorder() = default;

void Recorder::scene(pb::RecordedScene scene) {
  thread_->leave([&](Thread::Word& word) { word.scenes.push_back(std::move(scene)); });
}
void Recorder::start(const std::string& label) {
  thread_->leave([&](Thread::Word& word) {
    word.start = label;
    word.stop = false;
  });
}
void Recorder::stop() {
  thread_->leave([](Thread::Word& word) {
    word.stop = true;
    word.start.reset();
  });
}
void Recorder::mark(const std::string& text, const std::string& who) {
  pb::RecordedEvent event;
  event.set_at_ns(monotonic_now());
  event.set_kind(pb::RecordedEvent::MARK);
  event.set_text(text);
  event.set_who(who);
  thread_->leave([&](Thread::Word& word) { word.marks.push_back(std::move(event)); });
}
bool Recorder::end(Nanos patience) { return thread_->end(patience); }
RecorderState Recorder::state() const { return thread_->state(); }
const std::string& Recorder::folder() const noexcept { return thread_->folder(); }
bool Recorder::asked() const noexcept { return thread_->asked(); }

bool is_record_label(const std::string& label) {
  constexpr std::size_t kLongest = 40;
  return !label.empty() && label.size() <= kLongest &&
         std::all_of(label.begin(), label.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  c == '-' || c == '_';
         });
}

}  // namespace handrail
