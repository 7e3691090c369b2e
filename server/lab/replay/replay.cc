#include "server/lab/replay/replay.h"

#include <google/protobuf/util/message_differencer.h>

#include <utility>

#include "server/lab/replay/replay_side.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/record_feed.h"

namespace handrail {
namespace {

// One recording, from its first message to its last.
class Replay {
 public:
  explicit Replay(const ReplayOptions& options)
      : options_(options), scenes_(options.overrides, options.scene) {}

  Result<ReplayResult> run(std::istream& in) {
    McapReader reader(in);
    std::uint64_t count = 0;
    while (const auto message = reader.next()) {
      constexpr std::uint64_t kAsked = 4096;  // messages between two questions
      if (options_.cancelled && count++ % kAsked == 0 && options_.cancelled()) {
        return Status::error("cancelled");
      }
      const McapSchema* schema = reader.schema_of(message->channel);
      if (schema == nullptr) continue;
      if (Status taken = take(schema->name, message->data); !taken) return taken;
    }
    result_.damage = reader.damage();
    if (!side_) {
      return Status::error(result_.damage.empty()
                               ? "no recording of Handrail: it has no message of channel /start"
                               : result_.damage);
    }
    return result_;
  }

 private:
  Status take(const std::string& type, std::string_view bytes) {
    if (type == "handrail.pb.RecordedStart") return start(bytes);
    if (type == "handrail.pb.RecordedScene") {
      pb::RecordedScene scene;
      if (!parse(bytes, scene)) return unreadable(type);
      return scenes_.add(scene);
    }
    if (type == "handrail.pb.RecordedEvent") return event(bytes);
    if (!side_) return Status::ok();  // what came before the start is of nobody
    if (type == "handrail.pb.RecordedImage") {
      pb::RecordedImage image;
      if (!parse(bytes, image)) return unreadable(type);
      const bool memory = image.part_size() > 0;
      if (memory && !(options_.images && result_.same_build)) return Status::ok();
      return side_->image(image);
    }
    if (type == "handrail.pb.RecordedTick" || type == "handrail.pb.RecordedCycle") {
      return side_->entry(bytes, result_);
    }
    return Status::ok();  // of somebody else, or of a later version
  }

  Status start(std::string_view bytes) {
    pb::RecordedStart start;
    if (!parse(bytes, start)) return unreadable("handrail.pb.RecordedStart");
    result_.program = start.program();
    result_.version = start.version();
    result_.why = start.why();
    result_.same_build = start.build() == record_build();
    auto side = make_replay_side(start, scenes_, options_);
    if (!side) return side.status();
    side_ = std::move(*side);
    return Status::ok();
  }

  Status event(std::string_view bytes) {
    pb::RecordedEvent event;
    if (!parse(bytes, event)) return unreadable("handrail.pb.RecordedEvent");
    if (event.kind() == pb::RecordedEvent::LOST) {
      result_.lost += event.count();
      if (side_) side_->interrupt();
      return Status::ok();
    }
    result_.happened.push_back({event.at_ns(), event.text()});
    return Status::ok();
  }

  static bool parse(std::string_view bytes, google::protobuf::Message& out) {
    return out.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
  }
  static Status unreadable(const std::string& type) {
    return Status::error("a message that is no " + type);
  }

  const ReplayOptions& options_;
  RecordedScenes scenes_;
  std::unique_ptr<ReplaySide> side_;
  ReplayResult result_;
};

// What MessageDifferencer says, in one line.
std::string difference_text(const google::protobuf::Message& was,
                            const google::protobuf::Message& is, bool exact) {
  google::protobuf::util::MessageDifferencer differ;
  google::protobuf::util::DefaultFieldComparator numbers;
  if (!exact) {
    numbers.set_float_comparison(google::protobuf::util::DefaultFieldComparator::APPROXIMATE);
    numbers.SetDefaultFractionAndMargin(kOtherBuild, kOtherBuild);
  }
  numbers.set_treat_nan_as_equal(true);
  differ.set_field_comparator(&numbers);
  std::string out;
  differ.ReportDifferencesToString(&out);
  if (differ.Compare(was, is)) return {};
  return out.substr(0, out.find('\n'));
}

}  // namespace

void ReplayCompare::compare(const google::protobuf::Message& was,
                            const google::protobuf::Message& is, std::uint64_t number, Nanos at,
                            ReplayResult& result) {
  if (first_at_ < 0) first_at_ = at;
  ++result.replayed;
  was.SerializeToString(&was_);
  is.SerializeToString(&is_);
  if (was_ == is_) return;
  const std::string text = difference_text(was, is, exact_);
  if (text.empty()) return;  // not a number twice, or within what another build may differ
  ++result.different;
  if (!result.first) result.first = {number, to_seconds(at - first_at_), text};
}

Result<std::unique_ptr<ReplaySide>> make_replay_side(const pb::RecordedStart& start,
                                                     const RecordedScenes& scenes,
                                                     const ReplayOptions& options) {
  if (start.has_device()) return replay_master(start, scenes, options);
  if (start.has_arm()) return replay_slave(start, scenes, options);
  return Status::error("the recording's start tells neither of a haptic device nor of an arm");
}

Result<ReplayResult> replay(std::istream& in, const ReplayOptions& options) {
  return Replay(options).run(in);
}

}  // namespace handrail
