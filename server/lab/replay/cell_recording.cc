#include "server/lab/replay/cell_recording.h"

#include <utility>

#include "proto/config.pb.h"
#include "proto/record.pb.h"
#include "server/record/device_io.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/record_feed.h"
#include "server/record/record_setup.h"

namespace handrail {
namespace {

constexpr Nanos kChunk = 100 * kMillisecond;  // as of the daemons' recordings, at most

}  // namespace

// One of the two files.
class CellRecording::Side final : public RecordSink {
 public:
  Side(std::unique_ptr<RecordFeed> feed, pb::RecordedStart start, const pb::RecordedScene& scene,
       std::ostream& out)
      : feed_(std::move(feed)), out_(out), file_(record_layout()) {
    put(file_.begin());
    // The clocks of virtual time begin with the calendar.
    start.set_build(record_build());
    start.set_monotonic_ns(0);
    start.set_calendar_ns(0);
    start.set_why("a cell in virtual time");
    message(RecordChannel::kStart, 0, start.SerializeAsString());
    message(RecordChannel::kScene, 0, scene.SerializeAsString());
  }

  void pull() { feed_->pull(*this); }
  void finish() {
    pull();
    close_chunk();
    put(file_.end());
    out_.flush();
  }
  void event(pb::RecordedEvent::Kind kind, Nanos at, const std::string& text) {
    pb::RecordedEvent event;
    event.set_at_ns(at);
    event.set_kind(kind);
    event.set_text(text);
    message(RecordChannel::kEvent, at, event.SerializeAsString());
  }
  Nanos newest() const { return newest_; }

  void message(RecordChannel channel, Nanos at, std::string_view bytes) override {
    newest_ = at;
    const auto time = static_cast<std::uint64_t>(at);
    if (!building_.empty() && time >= building_.first() + kChunk) close_chunk();
    building_.add({static_cast<std::uint16_t>(channel), ++sequence_, time, time, bytes});
  }
  void beginning() override { close_chunk(); }
  void happened(pb::RecordedEvent::Kind kind, Nanos at, const std::string& text) override {
    event(kind, at, text);
  }
  Nanos calendar(Nanos at) const override { return at; }
  void wanted(bool) override {}

 private:
  void put(const std::string& bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  void close_chunk() {
    if (building_.empty()) return;
    const McapChunk chunk = building_.close();
    file_.add(chunk);
    put(chunk.bytes);
  }

  std::unique_ptr<RecordFeed> feed_;
  std::ostream& out_;
  McapFile file_;
  McapChunkBuilder building_;
  std::uint32_t sequence_ = 0;
  Nanos newest_ = 0;
};

pb::RecordedStart cell_master(const pb::MasterConfig& config, const HapticCapabilities& device) {
  pb::RecordedStart out = recorded_start("handrail-master", 1, config);
  put(device, *out.mutable_device());
  return out;
}

pb::RecordedStart cell_slave(Nanos period, double sensor_range) {
  pb::RecordedStart out = recorded_start("handrail-slave", 1, pb::SlaveConfig());
  *out.mutable_arm() = recorded_arm(period, true, sensor_range);
  return out;
}

CellRecording::CellRecording(Cell& cell, const pb::RecordedStart& master,
                             const pb::RecordedStart& slave, const pb::RecordedScene& scene,
                             std::ostream& to_master, std::ostream& to_slave)
    : cell_(cell),
      master_tap_(std::make_unique<MasterTap>()),
      slave_tap_(std::make_unique<SlaveTap>()) {
  master_ = std::make_unique<Side>(make_feed(*master_tap_), master, scene, to_master);
  slave_ = std::make_unique<Side>(make_feed(*slave_tap_), slave, scene, to_slave);
  cell_.keep(master_tap_.get(), slave_tap_.get());
}

CellRecording::~CellRecording() { cell_.keep(nullptr, nullptr); }

void CellRecording::pull() {
  master_->pull();
  slave_->pull();
}

void CellRecording::mark(const std::string& text) {
  pull();
  for (Side* side : {master_.get(), slave_.get()}) {
    side->event(pb::RecordedEvent::MARK, side->newest(), text);
  }
}

void CellRecording::finish() {
  master_->finish();
  slave_->finish();
}

}  // namespace handrail
