#include "server/record/record_feed.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/base/version.h"
#include "server/model/reason.h"
#include "server/record/mcap/message_schema.h"
#include "server/record/record_views.h"
#include "server/record/tick_io.h"

namespace handrail {
namespace {

// What a side says of its session, from one tick to the next.
class SessionSigns {
 public:
  // Tells of a stop or a fault that was not there before.
  void see(SessionState state, std::uint64_t stops, Reason why, Nanos at, RecordSink& sink) {
    if (known_ && stops != stops_) {
      sink.happened(pb::RecordedEvent::STOP, at, "a stop was latched");
    } else if (known_ && state == SessionState::kFault && state_ != state) {
      sink.happened(pb::RecordedEvent::FAULT, at, describe(why));
    }
    known_ = true;
    stops_ = stops;
    state_ = state;
  }

 private:
  bool known_ = false;
  std::uint64_t stops_ = 0;
  SessionState state_ = SessionState::kOff;
};

// The state of the other side stands in a message when it has changed: most ticks have the same one
// as the tick before.
class Unchanged {
 public:
  template <typename State>
  bool same(const State& state) {
    state.SerializeToString(&scratch_);
    if (scratch_ == last_) return true;
    std::swap(scratch_, last_);
    return false;
  }
  void forget() { last_.clear(); }

 private:
  std::string last_, scratch_;
};

// Chosen: longer than what an operator waits through, and it costs 3 MB a minute.
constexpr Nanos kMasterGone = 10 * kSecond;

// The datagrams of one thread.
class PacketFeed {
 public:
  explicit PacketFeed(PacketTap& tap) : tap_(tap), packet_(std::make_unique<KeptPacket>()) {}

  // Of each what is to be written, in turn.
  template <typename Tell>
  void pull(const Tell& tell) {
    for (std::size_t i = 0; i < PacketTap::kRoom && tap_.take(*packet_); ++i) {
      const std::span<const std::uint8_t> kept = packet_->kept();
      out_.Clear();
      out_.set_at_ns(packet_->at);
      out_.set_way(static_cast<pb::RecordedPacket::Way>(packet_->way));
      out_.set_packet(kept.data(), kept.size());
      if (packet_->size > kept.size()) out_.set_whole_bytes(packet_->size);
      tell(out_);
    }
  }
  std::uint64_t lost() const { return tap_.lost(); }

 private:
  PacketTap& tap_;
  std::unique_ptr<KeptPacket> packet_;
  pb::RecordedPacket out_;
};

// What both feeds do.
template <typename Tap>
class Feed : public RecordFeed {
 public:
  Feed(Tap& tap, const std::vector<PacketTap*>& packets)
      : tap_(tap),
        entry_(std::make_unique<typename Tap::Kept>()),
        image_(std::make_unique<typename Tap::Image>()) {
    for (PacketTap* of : packets) packets_.emplace_back(*of);
  }

  void pull(RecordSink& sink) override {
    waits_ = waits_ || tap_.take(*image_);
    for (std::size_t i = 0; i < kMostKept && tap_.take(*entry_); ++i) {
      tell_lost(tap_.lost(), told_lost_, "the recorder was behind", entry_->at, sink);
      // An image is taken before its tick is.
      while (waits_ || (waits_ = tap_.take(*image_))) {
        if (image_->number > entry_->number) break;
        if (image_->number == entry_->number) put_image(entry_->at, sink);
        waits_ = false;
      }
      put_entry(*entry_, sink);
    }
    std::uint64_t lost_packets = 0;
    Nanos newest = entry_->at;
    for (PacketFeed& feed : packets_) {
      feed.pull([&](const pb::RecordedPacket& packet) {
        newest = packet.at_ns();
        tell(RecordChannel::kPacket, newest, packet, sink);
      });
      lost_packets += feed.lost();
    }
    tell_lost(lost_packets, told_lost_packets_, "the recorder was behind: packets", newest, sink);
  }
  std::uint64_t lost() const override {
    std::uint64_t all = tap_.lost();
    for (const PacketFeed& feed : packets_) all += feed.lost();
    return all;
  }

 protected:
  virtual void put_entry(const typename Tap::Kept& entry, RecordSink& sink) = 0;
  template <typename Message>
  void tell(RecordChannel channel, Nanos at, const Message& message, RecordSink& sink) {
    message.SerializeToString(&bytes_);
    sink.message(channel, at, bytes_);
  }
  Unchanged other_;
  SessionSigns signs_;

 private:
  void put_image(Nanos at, RecordSink& sink) {
    sink.beginning();
    other_.forget();
    pb::RecordedImage out;
    out.set_number(image_->number);
    out.set_scene(image_->scene);
    if (image_->begins != 0) {
      out.set_begins(image_->begins);
    } else {
      out.add_part(image_->bytes.data(), image_->size);
    }
    tell(RecordChannel::kImage, at, out, sink);
  }
  // `told`: of `lost` so many have been told already.
  void tell_lost(std::uint64_t lost, std::uint64_t& told, const char* why, Nanos at,
                 RecordSink& sink) {
    const std::uint64_t more = lost - std::exchange(told, lost);
    if (more == 0) return;
    pb::RecordedEvent out;
    out.set_at_ns(at);
    out.set_kind(pb::RecordedEvent::LOST);
    out.set_count(more);
    out.set_text(why);
    tell(RecordChannel::kEvent, at, out, sink);
  }

  Tap& tap_;
  std::unique_ptr<typename Tap::Kept> entry_;
  std::unique_ptr<typename Tap::Image> image_;
  bool waits_ = false;  // the image's tick has not come yet
  std::vector<PacketFeed> packets_;
  std::uint64_t told_lost_ = 0, told_lost_packets_ = 0;
  std::string bytes_;
};

class MasterFeed final : public Feed<MasterTap> {
 public:
  using Feed::Feed;
  const char* side() const override { return "master"; }

 private:
  void put_entry(const KeptTick& tick, RecordSink& sink) override {
    put(tick, message_);
    if (message_.has_slave() && other_.same(message_.slave())) message_.clear_slave();
    tell(RecordChannel::kTick, tick.at, message_, sink);
    views_.see(tick, sink);
    const HapticOutput& out = tick.came.out;
    signs_.see(out.link.state, out.link.stop_epoch, out.reason, tick.at, sink);
  }
  pb::RecordedTick message_;
  RecordViews views_{"handrail-master"};
};

class SlaveFeed final : public Feed<SlaveTap> {
 public:
  using Feed::Feed;
  const char* side() const override { return "slave"; }

 private:
  void put_entry(const KeptCycle& cycle, RecordSink& sink) override {
    put(cycle, message_);
    if (message_.has_master() && other_.same(message_.master())) message_.clear_master();
    tell(RecordChannel::kCycle, cycle.at, message_, sink);
    views_.see(cycle, sink);
    const FollowInput& given = cycle.given;
    if (given.master_known) {
      sink.wanted(given.master.record && given.master_age <= kMasterGone);
    }
    const SlaveState& out = cycle.came.link;
    signs_.see(out.state, out.stop_epoch, out.fault, cycle.at, sink);
  }
  pb::RecordedCycle message_;
  RecordViews views_{"handrail-slave"};
};

}  // namespace

McapLayout record_layout() {
  McapLayout out;
  out.library = std::string("handrail ") + program_version();
  const auto add = [&out](const char* topic, const google::protobuf::Descriptor& type) {
    out.schemas.push_back({type.full_name(), "protobuf", schema_of(type)});
    out.channels.push_back({static_cast<std::uint16_t>(out.schemas.size()), topic, "protobuf"});
  };
  add("/start", *pb::RecordedStart::descriptor());
  add("/scene", *pb::RecordedScene::descriptor());
  add("/image", *pb::RecordedImage::descriptor());
  add("/tick", *pb::RecordedTick::descriptor());
  add("/cycle", *pb::RecordedCycle::descriptor());
  add("/event", *pb::RecordedEvent::descriptor());
  add("/joints", *foxglove::JointStates::descriptor());
  add("/tip", *foxglove::PoseInFrame::descriptor());
  add("/tip/desired", *foxglove::PoseInFrame::descriptor());
  add("/log", *foxglove::Log::descriptor());
  add("/packet", *pb::RecordedPacket::descriptor());
  return out;
}

std::unique_ptr<RecordFeed> make_feed(MasterTap& tap, std::vector<PacketTap*> packets) {
  return std::make_unique<MasterFeed>(tap, packets);
}
std::unique_ptr<RecordFeed> make_feed(SlaveTap& tap, std::vector<PacketTap*> packets) {
  return std::make_unique<SlaveFeed>(tap, packets);
}

std::string record_build() {
  return std::string(program_version()) + " " + __VERSION__ + " " +
         std::to_string(HapticRun::kMostImage) + " " + std::to_string(kMostFollowImage);
}

}  // namespace handrail
