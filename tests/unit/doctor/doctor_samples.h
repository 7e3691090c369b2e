// Facts of a healthy pair of computers, to be spoilt one at a time.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "client/doctor/judge.h"
#include "server/keys/own_key.h"

namespace handrail::test {

inline Trusted entry(const std::string& name, Roles roles) {
  const auto key = OwnKey::generate();
  EXPECT_TRUE(key) << key.message();
  return {name, roles, key->public_key()};
}

inline pb::ProgramStatus sample_program() {
  pb::ProgramStatus out;
  out.set_version("0.1.0");
  out.set_wire_version(8);
  out.set_calendar_s(1.7e9);
  out.set_control_fifo(true);
  out.set_memory_locked(true);
  out.set_io_fifo(true);
  return out;
}

inline pb::Status sample_status() {
  pb::Status s;
  s.set_state("off");
  s.set_slave_state("off");
  s.set_scene("linear-movement");
  s.set_device("Phantom Omni");
  s.set_device_simulated(true);
  s.set_has_contact_force(true);
  s.set_packet_age_ms(0.4);
  s.set_link_quality("EXCELLENT");
  s.set_peer_quality("GOOD");
  s.mutable_ledger()->set_sentence("the arm holds: not engaged");
  s.mutable_ledger()->set_way_out("engage");
  *s.mutable_program() = *s.mutable_slave_program() = sample_program();
  pb::PeerStatus& peer = *s.mutable_peer();
  peer.set_encrypted(true);
  peer.set_place("arm.example");
  peer.set_name("cell");
  peer.set_key("3f2a-91bc-07de-55a1");
  peer.set_address("192.0.2.7:47002");
  peer.set_age_s(300.0);
  pb::LinkGate& gate = *s.mutable_gate();
  gate.set_window_s(1.0);
  gate.set_heard_share(1.0);
  gate.set_most_held_share(0.09);
  gate.set_most_lost_share(0.25);
  gate.set_loop_warn_ms(100.0);
  gate.set_loop_limit_ms(600.0);
  return s;
}

inline DoctorFacts healthy() {
  DoctorFacts f;
  f.version = "0.1.0";
  f.wire_version = 8;
  f.realtime_line = "the line for root";
  f.keys.folder = "/home/eve/.config/handrail";
  f.keys.key_path = f.keys.folder + "/key";
  f.keys.trusted_path = f.keys.folder + "/trusted";
  f.keys.has_key = true;
  f.keys.key_mode = f.keys.trusted_mode = "0600";
  f.keys.own = entry("desk", Role::kMaster);
  f.keys.own_age_s = 3 * 86400.0;
  f.keys.trusted = TrustList();
  EXPECT_TRUE(f.keys.trusted->add(entry("cell", Role::kSlave)));
  f.machine.user = "eve";
  f.machine.may_fifo = f.machine.may_lock = true;
  f.machine.most_priority = 90;
  f.machine.most_locked_kb = -1;
  f.machine.governors = {"performance"};
  f.machine.stolen_share = 0.001;
  f.machine.watched_s = 1.0;
  f.machine.clock_source = "tsc";
  f.machine.calendar_is_kept = true;
  f.master.place.socket = "/tmp/operator.sock";
  f.master.status = sample_status();
  f.master.round_trips_ms = {12.0, 14.0, 12.0, 12.5, 20.0};
  f.master.loop_ages_ms = {13.0, 15.0};
  f.master.watched_s = 1.0;
  f.route = RouteFacts{"192.0.2.7:47002", "", "eth0", 1500, false, Tunnel::kNone};
  f.largest_datagram = 613;
  f.largest_handshake = 1232;
  return f;
}

// The finding of `check`; a failure, and an empty one, where there is none or another besides.
inline Finding found(const DoctorFacts& facts, const std::string& check) {
  Finding out;
  int count = 0;
  for (const Finding& finding : judge(facts)) {
    if (finding.check != check) continue;
    out = finding;
    ++count;
  }
  EXPECT_EQ(count, 1) << check;
  return out;
}
inline pb::Status& status(DoctorFacts& facts) { return *facts.master.status; }
inline bool says(const DoctorFacts& facts, const std::string& check) {
  for (const Finding& finding : judge(facts)) {
    if (finding.check == check) return true;
  }
  return false;
}

// Level, and a part of what is said, and of what to do.
inline void expect_found(const DoctorFacts& facts, const std::string& check, Level level,
                         const std::string& fact, const std::string& next) {
  const Finding finding = found(facts, check);
  EXPECT_EQ(finding.level, level) << check << ": " << finding.fact;
  EXPECT_THAT(finding.fact, ::testing::HasSubstr(fact));
  EXPECT_THAT(finding.next, ::testing::HasSubstr(next));
  EXPECT_EQ(finding.next.empty(), level == Level::kOk) << check << ": " << finding.next;
}

}  // namespace handrail::test
