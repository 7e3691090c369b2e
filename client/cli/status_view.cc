#include "client/cli/status_view.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/lease_command.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

std::string number(double value, int decimals, int width = 0) {
  std::array<char, 64> buffer;
  const int n = std::snprintf(buffer.data(), buffer.size(), "%*.*f", width, decimals, value);
  return std::string(buffer.data(), static_cast<std::size_t>(n < 0 ? 0 : n < 64 ? n : 63));
}

// The master says -1 for "none yet".
std::string milliseconds(double value) {
  return value < 0.0 ? "none yet" : number(value, 2) + " ms";
}

constexpr std::size_t kWidth = 80, kIndent = 11;

// The label, then the parts side by side, on as many lines as they need.
std::string line(const char* label, std::initializer_list<std::string> parts) {
  std::string out, row = label;
  row.resize(kIndent, ' ');
  const auto next_row = [&] {
    out += row.substr(0, row.find_last_not_of(' ') + 1) + '\n';
    row.assign(kIndent, ' ');
  };
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    const bool first = row.size() == kIndent;
    const bool fits_a_row = part.size() <= kWidth - kIndent;
    if (!first && fits_a_row && row.size() + 2 + part.size() > kWidth) next_row();
    if (row.size() > kIndent) row += "  ";
    // One that is longer than a line goes on where a word ends.
    std::string rest = part;
    while (row.size() + rest.size() > kWidth) {
      const std::size_t cut = rest.rfind(' ', kWidth - row.size());
      if (cut == std::string::npos || cut == 0) break;
      row += rest.substr(0, cut);
      rest = rest.substr(cut + 1);
      next_row();
    }
    row += rest;
  }
  next_row();
  return out;
}

std::string labelled(const char* label, const std::string& value) {
  return std::string(label) + " " + (value.empty() ? "-" : value);
}

std::string vector_text(const Numbers& v, int decimals, int width) {
  std::string out;
  for (const double x : v) out.append(out.empty() ? "" : " ").append(number(x, decimals, width));
  return out.empty() ? "-" : out;
}

// A part of the screen. Where there are too many rows, those of the greatest `spare` go first.
struct Section {
  std::string text;
  int spare = 0;
  long least = 1;  // rows that stay

  long rows() const { return std::count(text.begin(), text.end(), '\n'); }
  // Without its last row, and the new last one says so.
  void cut() {
    text.pop_back();
    text.erase(text.rfind('\n') + 1);
    text.pop_back();
    const std::size_t last = text.rfind('\n') + 1;  // npos + 1 is 0
    constexpr std::size_t kRoom = kWidth - 4;
    if (text.size() - last > kRoom) {
      text.erase(std::max(text.rfind(' ', last + kRoom), last + kIndent));
    }
    text += " ...\n";
  }
};
using Screen = std::vector<Section>;

std::string fitted(Screen screen, long most_rows) {
  long rows = 0;
  for (const Section& section : screen) rows += section.rows();
  for (; rows > most_rows; --rows) {
    Section* longest = nullptr;
    for (Section& section : screen) {
      if (section.rows() <= section.least) continue;
      if (longest == nullptr || section.spare > longest->spare) longest = &section;
    }
    if (longest == nullptr) break;
    longest->cut();
  }
  std::string out;
  for (const Section& section : screen) out += section.text;
  return out;
}

// What master and slave are, where it is not the same.
std::string program_differences(const pb::Status& s) {
  if (!s.has_slave_program()) return {};
  const pb::ProgramStatus &master = s.program(), &slave = s.slave_program();
  const auto says = [](const char* what, const std::string& ours, const std::string& its) {
    return line("", {std::string("differs: ") + what + ": master " + ours + ", slave " + its});
  };
  if (master.wire_version() != slave.wire_version()) {
    return says("wire version", std::to_string(master.wire_version()),
                std::to_string(slave.wire_version()));
  }
  return master.version() == slave.version() ? std::string()
                                             : says("version", master.version(), slave.version());
}

void add_session(const pb::Status& s, Screen& screen) {
  screen.push_back({line("session", {s.state(), labelled("reason:", s.reason())}), 1});
  screen.push_back({line("", {labelled("wanted:", s.desired()), labelled("slave:", s.slave_state()),
                              labelled("reason:", s.slave_reason())}),
                    3});
  std::string also, differs;
  for (const std::string& text : s.interventions()) {
    if (text != s.reason()) also += line("", {"also: " + text});
  }
  differs = program_differences(s);
  for (const std::string& text : s.hash_mismatch()) differs += line("", {"differs: " + text});
  if (!also.empty()) screen.push_back({also, 6});
  if (s.has_ledger()) screen.push_back({line("why", {why_text(s.ledger())}), 0, 2});
  if (s.has_lease()) screen.push_back({line("lease", {lease_text(s.lease())}), 2});
  screen.push_back(
      {line("scene", {s.scene().empty() ? "-" : s.scene(), labelled("slave:", s.slave_scene())})});
  if (!differs.empty()) screen.push_back({differs, 6});
  screen.push_back({line("device", {s.device() + (s.device_simulated() ? " (simulated)" : ""),
                                    s.hand_moving() ? "hand moving" : "", s.device_trouble()})});
}

// With whom, where keys say it.
std::string peer_text(const pb::PeerStatus& peer) {
  if (!peer.problem().empty()) return line("peer", {peer.problem()});
  if (!peer.encrypted()) return line("peer", {"no slave has answered at " + peer.place()});
  if (peer.name().empty()) return line("peer", {"encrypted link, no session"});
  return line("peer", {peer.name(), labelled("key", peer.key()), labelled("at", peer.address()),
                       labelled("for", number(peer.age_s(), 0) + " s"), "encrypted"});
}

std::string link_text(const pb::Status& s) {
  return line("link", {labelled("age", milliseconds(s.packet_age_ms())),
                       labelled("loss", number(100.0 * s.loss_share(), 1) + " %"),
                       labelled("round trip", milliseconds(s.round_trip_ms())),
                       labelled("oldest applied", milliseconds(s.oldest_applied_ms())),
                       labelled("quality", s.link_quality()), labelled("there", s.peer_quality()),
                       labelled("loop", milliseconds(s.loop_age_ms())),
                       labelled("accepted", std::to_string(s.datagrams_accepted())),
                       labelled("rejected", std::to_string(s.datagrams_rejected()))});
}

// Of a log that nobody reads to its end.
std::string log_text(const pb::Status& s) {
  std::vector<std::string> whose;
  if (s.log_lost() > 0) whose.push_back(std::to_string(s.log_lost()) + " of the master");
  if (s.slave_log_lost()) whose.push_back("some of the slave");
  std::string out = "log lines lost:";
  for (const std::string& one : whose) out.append(&one == &whose[0] ? " " : ", ").append(one);
  return out.append(" (nobody reads them, or the disk is full)");
}

std::string loop_text(const pb::Status& s) {
  const pb::Lateness& l = s.loop_lateness_us();
  return line("loop", {labelled("ticks", std::to_string(s.ticks())),
                       labelled("overruns", std::to_string(s.overruns())),
                       labelled("slave overruns", std::to_string(s.slave_overruns()))}) +
         line("", {"late [us]:", labelled("p50", number(l.p50(), 1)),
                   labelled("p99", number(l.p99(), 1)), labelled("p99.9", number(l.p999(), 1)),
                   labelled("max", number(l.max(), 1))});
}

std::string tool_text(const char* label, const pb::ToolStatus& tool, bool is_position) {
  if (tool.kind().empty() || tool.kind() == "none") return labelled(label, "none");
  std::string out = labelled(label, tool.kind()) + " #" + std::to_string(tool.id());
  out += (tool.name().empty() ? "" : " '" + tool.name() + "'") + ", ";
  out += is_position ? number(tool.deviation_mm(), 3) + " mm off"
                     : number(tool.deviation_deg(), 2) + " deg off";
  if (tool.turning()) return out + ", turning to it";
  return out + (tool.blending() ? ", easing in" : "");
}

// What `handrail tool call` takes.
std::string names_text(const pb::Status& s) {
  std::string out = "of the scene:";
  for (const pb::NamedToolStatus& tool : s.named_tool()) {
    out.append(&tool == &s.named_tool(0) ? " " : ", ").append(tool.name());
  }
  return out;
}

std::string share_text(const char* label, const pb::ForceShare& share) {
  return labelled(label, number(share.magnitude_n(), 3));
}

std::string pose_text(const char* label, const pb::PoseMm& pose) {
  std::string name = label;
  name.resize(13, ' ');
  if (pose.position_mm_size() == 0) return name + " -";
  return name + vector_text(pose.position_mm(), 2, 8) + " q " +
         vector_text(pose.quaternion(), 3, 6);
}

// Of the handle's sensor, under what the device was told.
std::string handle_text(const pb::Status& s) {
  const pb::HandleStatus& handle = s.handle();
  const std::string from = handle.simulated() ? "simulated" : handle.sensor();
  if (!handle.has_force()) return line("felt [N]", {handle.state(), from});
  const bool stick = handle.stick_torque_n_m_size() == 3;
  return line("felt [N]",
              {share_text("handle", handle.force()),
               stick ? "stick " + vector_text(handle.stick_torque_n_m(), 2, 0) + " N m" : "",
               handle.has_felt_share()
                   ? number(100.0 * handle.felt_share(), 0) + " % of what the device was told"
                   : "",
               from});
}

std::string walls_text(const pb::WallStatus& walls) {
  std::string stage = labelled("stage", std::to_string(walls.stage()));
  if (walls.has_stage_name()) stage += " '" + walls.stage_name() + "'";
  const std::string at = walls.region_name().empty() ? "" : " at '" + walls.region_name() + "'";
  const std::string by = walls.place().empty() ? "" : " in '" + walls.place() + "'";
  return line("walls", {stage,
                        (walls.touching() ? number(walls.penetration_mm(), 2) + " mm in a wall"
                                          : std::string("free")) +
                            at,
                        walls.locked() ? "locked" + by : "",
                        walls.has_turned_rad() ? "screw turned " + number(walls.turned_rad(), 2) +
                                                     " rad, c " + number(walls.screw_c(), 1)
                                               : ""});
}

}  // namespace

std::string why_text(const pb::Ledger& ledger) {
  return ledger.sentence() + (ledger.way_out().empty() ? "" : "; way out: " + ledger.way_out());
}

std::string status_text(const pb::Status& s, long most_rows) {
  Screen screen;
  add_session(s, screen);
  screen.push_back({link_text(s), 4, 2});
  const bool alone = s.packet_age_ms() < 0.0 && s.peer().has_place() && !s.has_walls();
  if (s.peer().encrypted() || alone) screen.push_back({peer_text(s.peer()), 2});
  screen.push_back({loop_text(s), 0, 2});
  screen.push_back({line("", {labelled("real time:", s.realtime())}), 5});
  if (s.log_lost() > 0 || s.slave_log_lost()) screen.push_back({line("", {log_text(s)}), 5});
  screen.push_back({line("tools", {tool_text("position:", s.position_tool(), true),
                                   tool_text("orientation:", s.orientation_tool(), false)}),
                    0, 2});
  if (s.named_tool_size() > 0) screen.push_back({line("", {names_text(s)}), 5});
  const std::string force =
      line("force [N]",
           {share_text("tool", s.tool_force()), share_text("spring", s.spring_force()),
            share_text("limits", s.limited_force()), share_text("device", s.device_force())});
  screen.push_back({force + (s.has_handle() ? handle_text(s) : ""), 3});
  const std::string touch =
      s.has_contact_force() ? vector_text(s.contact_force_n(), 2, 0) : "no sensor";
  screen.push_back({s.has_gripper() ? line("touch [N]", {touch, labelled("gripper", s.gripper())})
                                    : line("touch [N]", {touch})});
  if (s.has_walls()) screen.push_back({walls_text(s.walls()), 2});
  screen.push_back({line("pose [mm]", {pose_text("command", s.command())})});
  screen.push_back({line("", {pose_text("slave command", s.slave_command())})});
  screen.push_back({line("", {pose_text("tip", s.tip())})});
  screen.push_back({line("", {pose_text("hand", s.hand())})});
  return fitted(std::move(screen), most_rows);
}

}  // namespace handrail
