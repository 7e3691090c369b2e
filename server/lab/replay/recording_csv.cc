#include "server/lab/replay/recording_csv.h"

#include <spdlog/fmt/fmt.h>

#include <sstream>
#include <string>

#include "proto/record.pb.h"
#include "server/base/units.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/tick_io.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

constexpr char kMasterColumns[] =
    "t_s,state,hand_x_mm,hand_y_mm,hand_z_mm,force_x_n,force_y_n,force_z_n,command_x_mm,"
    "command_y_mm,command_z_mm,tip_x_mm,tip_y_mm,tip_z_mm,off_tool_mm,off_tool_deg,"
    "tool_force_n,spring_force_n,wall_hand_x_mm,wall_hand_y_mm,proxy_x_mm,proxy_y_mm,stage,"
    "locked,turned_deg,felt_x_n,felt_y_n,felt_z_n\n";
constexpr char kSlaveColumns[] =
    "t_s,state,target_1_deg,target_2_deg,target_3_deg,target_4_deg,target_5_deg,target_6_deg,"
    "joint_1_deg,joint_2_deg,joint_3_deg,joint_4_deg,joint_5_deg,joint_6_deg,tip_x_mm,tip_y_mm,"
    "tip_z_mm,contact_x_n,contact_y_n,contact_z_n\n";

// The first `count` numbers, in a unit; empty fields where they are not there.
std::string fields(const Numbers& values, int count, double unit, int from = 0) {
  std::string out;
  for (int i = from; i < from + count; ++i) {
    out += i < values.size() ? fmt::format(",{:.9g}", values[i] / unit) : ",";
  }
  return out;
}

double length(const Numbers& values, int from) {
  if (values.size() < from + 3) return 0.0;
  return Vec3(values[from], values[from + 1], values[from + 2]).norm();
}

std::string row(const pb::RecordedTick& tick, double t, const Numbers& tip) {
  std::string out = fmt::format("{:.6f},{}", t, static_cast<int>(tick.command().state()));
  out += fields(tick.hand(), 3, kMm) + fields(tick.wrench(), 3, 1.0);
  out += fields(tick.command().command_pose(), 3, kMm) + fields(tip, 3, kMm);
  out +=
      fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g}", tick.deviation() / kMm,
                  tick.deviation_angle() / kDeg, length(tick.force(), 0), length(tick.force(), 6));
  const std::string felt = fields(tick.handle(), 3, 1.0) + "\n";
  if (!tick.has_walls()) return out + ",,,,,,," + felt;
  const pb::RecordedWalls& walls = tick.walls();
  out += fields(walls.hand(), 2, kMm) + fields(walls.proxy(), 2, kMm);
  return out +
         fmt::format(",{},{},{:.9g}", walls.stage(), walls.locked() ? 1 : 0,
                     walls.turned() / kDeg) +
         felt;
}

std::string row(const pb::RecordedCycle& cycle, double t) {
  const pb::SlaveDatagram& state = cycle.state();
  return fmt::format("{:.6f},{}", t, static_cast<int>(state.state())) +
         fields(cycle.q_target(), 6, kDeg) + fields(cycle.q_measured(), 6, kDeg) +
         fields(state.measured_pose(), 3, kMm) + fields(state.wrench(), 3, 1.0) + "\n";
}

// Which of the ticks are written.
class Thinning {
 public:
  explicit Thinning(double hz) : period_(hz > 0.0 ? 1.0 / hz : 0.0) {}
  bool takes(double t) {
    if (t + 1e-9 < next_) return false;
    // Half a millisecond: a tick that comes a little early is still the nearest.
    while (period_ > 0.0 && next_ <= t + 5e-4) next_ += period_;
    return true;
  }

 private:
  double period_;
  double next_ = 0.0;
};

// Whether the time is within the wanted trial, as marks tell.
class TrialGate {
 public:
  explicit TrialGate(int wanted) : wanted_(wanted), open_(wanted == 0) {}
  bool open() const { return open_; }
  bool seen() const { return seen_; }
  void see(const pb::RecordedEvent& event) {
    if (wanted_ == 0 || event.kind() != pb::RecordedEvent::MARK) return;
    // trial begins: EXPERIMENT MODE SUBJECT NUMBER ...
    std::istringstream words(event.text());
    std::string trial, what, skipped;
    int number = 0;
    if (!(words >> trial >> what >> skipped >> skipped >> skipped >> number)) return;
    if (trial != "trial" || number != wanted_) return;
    if (what == "begins:") open_ = seen_ = true;
    if (what == "ends:") open_ = false;
  }

 private:
  int wanted_;
  bool open_;
  bool seen_ = false;
};

const char* way_text(pb::RecordedPacket::Way way) {
  switch (way) {
    case pb::RecordedPacket::LINK_IN: return "link in";
    case pb::RecordedPacket::LINK_OUT: return "link out";
    case pb::RecordedPacket::ROBOT_IN: return "robot in";
    case pb::RecordedPacket::ROBOT_OUT: return "robot out";
    case pb::RecordedPacket::SENSOR_IN: return "sensor in";
    case pb::RecordedPacket::SENSOR_OUT: return "sensor out";
  }
  return "";
}

}  // namespace

Result<std::uint64_t> write_recording_csv(std::istream& in, std::ostream& out, double hz,
                                          int trial) {
  McapReader reader(in);
  TrialGate gate(trial);
  pb::RecordedEvent event;
  pb::RecordedTick tick;
  pb::RecordedCycle cycle;
  Numbers tip;
  Nanos begun = -1;
  std::uint64_t rows = 0;
  Thinning thinning(hz);
  const auto time = [&](Nanos at) {
    if (begun < 0) begun = at;
    return to_seconds(at - begun);
  };
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema_of(message->channel);
    const auto size = static_cast<int>(message->data.size());
    std::string text;
    if (schema != nullptr && schema->name == "handrail.pb.RecordedEvent" &&
        event.ParseFromArray(message->data.data(), size)) {
      gate.see(event);
    } else if (schema != nullptr && schema->name == "handrail.pb.RecordedTick") {
      if (!tick.ParseFromArray(message->data.data(), size)) {
        return Status::error("a message that is no handrail.pb.RecordedTick");
      }
      if (tick.has_slave()) tip = tick.slave().measured_pose();
      if (!gate.open()) continue;
      const double t = time(tick.at_ns());
      if (rows == 0) out << kMasterColumns;
      if (thinning.takes(t)) text = row(tick, t, tip);
    } else if (schema != nullptr && schema->name == "handrail.pb.RecordedCycle") {
      if (!cycle.ParseFromArray(message->data.data(), size)) {
        return Status::error("a message that is no handrail.pb.RecordedCycle");
      }
      if (!gate.open()) continue;
      const double t = time(cycle.at_ns());
      if (rows == 0) out << kSlaveColumns;
      if (thinning.takes(t)) text = row(cycle, t);
    }
    if (text.empty()) continue;
    ++rows;
    if (!(out << text)) return Status::error("the table cannot be written: is the disk full?");
  }
  if (rows > 0) return rows;
  if (trial > 0 && reader.damage().empty()) {
    return Status::error("it has no trial " + std::to_string(trial) +
                         (gate.seen() ? " with ticks" : " that is marked"));
  }
  return Status::error(reader.damage().empty() ? "it holds neither ticks nor cycles"
                                               : reader.damage());
}

Result<std::uint64_t> write_packets_csv(std::istream& in, std::ostream& out) {
  McapReader reader(in);
  pb::RecordedPacket packet;
  Nanos begun = 0;
  std::uint64_t rows = 0;
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema_of(message->channel);
    if (schema == nullptr || schema->name != "handrail.pb.RecordedPacket") continue;
    if (!packet.ParseFromArray(message->data.data(), static_cast<int>(message->data.size())))
      return Status::error("a message that is no handrail.pb.RecordedPacket");
    if (rows == 0) {
      out << "t_s,way,bytes,packet\n";
      begun = packet.at_ns();
    }
    const std::string& kept = packet.packet();
    const auto size = packet.has_whole_bytes() ? packet.whole_bytes() : kept.size();
    ++rows;
    out << fmt::format("{:.6f},{},{},", to_seconds(packet.at_ns() - begun), way_text(packet.way()),
                       size);
    for (const char byte : kept) out << fmt::format("{:02x}", static_cast<unsigned char>(byte));
    if (!(out << '\n')) return Status::error("the table cannot be written: is the disk full?");
  }
  if (rows > 0) return rows;
  return Status::error(reader.damage().empty() ? "it holds no datagrams" : reader.damage());
}

}  // namespace handrail
