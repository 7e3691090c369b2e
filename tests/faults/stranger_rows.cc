// Rows of strangers: without the right key, with what they overheard, or with very much of nothing.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>

#include "server/base/clock.h"
#include "server/keys/key_folder.h"
#include "server/link/codec.h"
#include "tests/emulator/report_text.h"
#include "tests/emulator/tap.h"
#include "tests/faults/forged.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

constexpr const char* kSlaveAt = "10.77.0.2:47002";

int count_of(const std::string& text, const std::string& part) {
  int out = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; ++at) ++out;
  return out;
}

// A master of its own on near with other keys, which trusts the slave. `let_in`: the roles that the
// slave's list gives its key; none: it is not in it.
struct Caller {
  const char* name;
  bool trusted;         // the slave's list has it
  Roles roles;          // there
  bool removed;         // and has it no more
  const char* refused;  // part of what it is told
};

void call(Trial& trial, Bed& bed, const Caller& caller) {
  const std::string folder = bed.folder() + "/" + caller.name;
  const KeyFolder own(folder), cell(bed.keys(Who::kSlave));
  const auto key = own.create(caller.name, Role::kMaster);
  const auto slave = cell.load();
  auto list = cell.trusted();
  TrustList slaves;
  if (!key || !slave || !list || !slaves.add(slave->entry()) || !own.save(slaves, "a fault row")) {
    return bed.problem(std::string("no keys for ") + caller.name);
  }
  if (caller.trusted) {
    (void)list->add({caller.name, caller.roles, key->key.public_key()});
    (void)cell.save(*list, "a fault row");
    bed.drive(1200 * kMillisecond);  // within a second the slave has it
    if (caller.removed && list->remove(caller.name)) (void)cell.save(*list, "a fault row");
    bed.drive(1200 * kMillisecond);
  }
  const std::string config = bed.folder() + "/" + caller.name + ".cfg";
  std::ofstream(config) << fmt::format(
      "operator_socket: '{}/{}.socket/op.sock' scene: 'storm' "
      "scene_path: '{}'",
      bed.folder(), caller.name, bed.folder());
  const Status ran =
      bed.run("near", caller.name,
              fmt::format("HANDRAIL_KEYS={} exec {}/handrail-master --config {} --link 10.77.0.2",
                          folder, HANDRAIL_BIN_DIR, config));
  if (!ran) bed.problem(ran.message());
  bed.drive(2500 * kMillisecond);
  const std::string said = bed.printed("near", caller.name);
  (void)bed.emulator(std::string("signal near ") + caller.name + " TERM");
  trial.check(said.find(caller.refused) != said.npos,
              std::string(caller.name) + " is not told: " + said);
  trial.check(said.find("encrypted session with") == said.npos,
              std::string(caller.name) + " has a session");
}

// OpenSSL's client with these arguments: the slave ends it by an alert.
void call_by_openssl(Trial& trial, Bed& bed, const std::string& name,
                     const std::string& arguments) {
  const Status ran = bed.run(
      "near", name,
      fmt::format("sleep 2 | timeout 2 openssl s_client -connect {} {}", kSlaveAt, arguments));
  if (!ran) bed.problem(ran.message());
  bed.drive(2300 * kMillisecond);
  const std::string said = bed.printed("near", name);
  trial.check(said.find("SSL alert number") != said.npos, name + " is not refused: " + said);
}

// What far answered to each of the addresses 192.0.2.n, against what came from there.
void judge_answers(Trial& trial, const std::string& path) {
  std::map<std::uint32_t, std::array<std::uint64_t, 2>> bytes;  // by source: asked, answered
  const Status read = emulator::scan_tap(path, [&bytes](emulator::TapRecord& r) {
    const auto layout = emulator::layout_of(r.packet);
    if (!layout || r.packet[0] >> 4 != 4) return;
    const auto end = r.sent ? emulator::destination_of(r.packet, *layout)
                            : emulator::source_of(r.packet, *layout);
    const auto& a = end.address.bytes;
    if (a[0] != 192 || a[1] != 0 || a[2] != 2) return;
    bytes[static_cast<std::uint32_t>(a[3]) << 16 | end.port][r.sent ? 1 : 0] += r.packet.size();
  });
  if (!read) return trial.check(false, read.message());
  std::uint64_t asked = 0, answered = 0;
  int more = 0;
  for (const auto& [end, of] : bytes) {
    asked += of[0];
    answered += of[1];
    more += of[1] > of[0] ? 1 : 0;
  }
  trial.measure(fmt::format("{} bytes from {} spoofed sources, {} bytes to them", asked,
                            bytes.size(), answered));
  trial.check(more == 0, fmt::format("{} sources were sent more than they sent", more));
}

// The address is nobody's, so that answers show in the tap and go nowhere.
emulator::Endpoint nobody(int i) {
  emulator::Endpoint out = *emulator::read_endpoint("192.0.2.1:1024");
  out.address.bytes[3] = static_cast<std::uint8_t>(1 + i % 250);
  out.port = static_cast<std::uint16_t>(1024 + i / 250 % 60'000);
  return out;
}

Result<SeenSession> overheard(Bed& bed) {
  if (const auto report = bed.emulator("report"); !report) return report.status();
  return see_session(bed.folder() + "/far.pcap");
}

// Has the emulator send the packets of a file to a side, and drives until they are through.
void send_all(Bed& bed, const std::string& side, const std::string& path, int count, int rate) {
  const auto before = bed.emulator("report");
  const std::string way = "to_" + side;
  const double wanted =
      (before ? emulator::count(*before, way, "injected") : 0.0) + static_cast<double>(count);
  if (const auto done = bed.emulator(fmt::format("replay {} {} {}", side, path, rate)); !done) {
    return bed.problem(done.message());
  }
  while (!bed.over()) {
    bed.drive(300 * kMillisecond);
    const auto now = bed.emulator("report");
    if (!now || emulator::count(*now, way, "injected") >= wanted) return;
  }
}

}  // namespace

RowResult x3(const RowRun& run) {
  const int hellos = run.full ? 100'000 : 20'000;
  Trial trial(
      run,
      "no certificate, unknown key, removed key, key with another role, DTLS 1.0, no cipher; "
      "hellos with an overheard cookie and without, from spoofed sources",
      "none let in, each that can be told is told why; no answer larger than the question");
  BedOptions whole;
  whole.tap_bytes = 1500;
  auto bed = trial.bed(whole);
  if (!bed) return trial.result();
  call(trial, *bed, {"unknown", false, {}, false, "does not trust our key"});
  call(trial, *bed, {"removed", true, Role::kMaster, true, "does not trust our key"});
  call(trial, *bed, {"observer", true, Role::kObserver, false, "does not trust our key"});
  if (std::filesystem::exists("/usr/bin/openssl")) {
    call_by_openssl(trial, *bed, "bare", "-dtls1_2");
    call_by_openssl(trial, *bed, "old", "-dtls1 -cipher ALL:@SECLEVEL=0");
    call_by_openssl(trial, *bed, "null", "-dtls1_2 -cipher NULL:@SECLEVEL=0");
  } else {
    trial.left_out("what openssl's client would try, there is none");
  }
  const auto seen = overheard(*bed);
  if (!seen) bed->problem(seen.message());
  const std::string path = bed->folder() + "/hellos.pcap";
  if (seen) {
    const auto to = *emulator::read_endpoint(kSlaveAt);
    const Status made = write_packets(path, hellos, [&](int i) {
      return emulator::make_udp(nobody(i), to, i % 2 == 0 ? seen->hello : seen->first_hello);
    });
    if (!made) bed->problem(made.message());
    send_all(*bed, "far", path, hellos, 20'000);
  }
  trial.check(bed->over() || bed->led(), "the arm is not led any more");
  const std::string log = bed->printed(Who::kSlave);
  (void)bed->emulator("report");
  judge_answers(trial, bed->folder() + "/far.pcap");
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.check(count_of(log, "encrypted session with") == 1, "a session with somebody else");
  trial.measure(fmt::format("{} gaps beside the machine's while they called", verdict.link.trips));
  return trial.result();
}

namespace {

// What one who sees the wire can forge for a session, as from `from` to `to`.
Bytes forgery(Random& random, const SeenSession& seen, bool to_slave, int i) {
  const auto& from = to_slave ? seen.master : seen.slave;
  const auto& to = to_slave ? seen.slave : seen.master;
  constexpr std::uint64_t kEpoch = std::uint64_t{1} << 48;
  constexpr std::uint64_t kAhead = 100'000;  // of the sequence, at most
  const std::uint64_t next =
      (i % 3 == 0 ? 0 : kEpoch) | ((seen.record & (kEpoch - 1)) + random.bits() % kAhead);
  Bytes payload;
  switch (i % 6) {
    // A state, a close in plain, a fatal alert, a change of ciphers, a hello's answer, and an alert
    // that is too short to be sealed in what OpenSSL takes for a record of another version.
    case 0: payload = record_of(23, kEpoch | next, random_bytes(random, 560)); break;
    case 1: payload = record_of(21, next, {1, 0}); break;
    case 2: payload = record_of(21, next, random_bytes(random, random.bits() % 40)); break;
    case 3: payload = record_of(20, next, {1}); break;
    case 4: {
      Bytes body(13);
      const Bytes hidden =
          record_of(21, kEpoch | next, random_bytes(random, 1 + random.bits() % 24));
      body.insert(body.end(), hidden.begin(), hidden.end());
      payload = record_of(static_cast<std::uint8_t>(20 + random.bits() % 3), next, body);
      payload[2] = 0xff;  // DTLS 1.0
      break;
    }
    default: payload = record_of(22, next, random_bytes(random, random.bits() % 200)); break;
  }
  if (i % 7 == 0) payload.resize(random.bits() % (payload.size() + 1));
  return emulator::make_udp(from, to, payload);
}

// The plain link's own bytes: a stop and a reset as an authentic master would say them.
Bytes plain(Codec& codec, const SeenSession& seen, int i) {
  DatagramHeader header;
  header.session = 1 + static_cast<std::uint64_t>(i % 3);
  header.sequence = 1 + static_cast<std::uint64_t>(i);
  MasterState state;
  state.stop_epoch = 1 + static_cast<std::uint64_t>(i);
  state.released_epoch = i % 2 == 0 ? 0 : state.stop_epoch;
  state.fault_reset = state.stop_epoch;
  Bytes bytes(kMaxDatagram);
  Reject cause = Reject::kNone;
  bytes.resize(codec.encode(header, state, bytes, cause));
  return emulator::make_udp(seen.master, seen.slave, bytes);
}

// The slave comes back with another key at the same place.
void swap_key(Trial& trial, Bed& bed) {
  const std::string folder = bed.folder() + "/other-keys";
  const KeyFolder other(folder), cell(bed.keys(Who::kSlave)), desk(bed.keys(Who::kMaster));
  const auto key = other.create("cell", Role::kSlave);
  const auto masters = cell.trusted();
  const auto before = cell.load();
  if (!key || !masters || !before || !other.save(*masters, "a fault row")) {
    return bed.problem("no other keys");
  }
  const std::string own = bed.keys(Who::kSlave);
  bed.signal(Who::kSlave, "TERM");
  bed.must_stop(monotonic_now() + kSecond);  // it brakes before it ends
  bed.wait(kSecond);
  bed.use_keys(Who::kSlave, folder);
  if (const Status started = bed.start(Who::kSlave); !started) bed.problem(started.message());
  bed.wait(3 * kSecond);
  const auto now = bed.status();
  const std::string told = now ? now->peer().problem() : "no master answers";
  const std::string shown = key_id(key->key.public_key());
  trial.check(
      told.find(shown) != told.npos && told.find(key_id(before->key.public_key())) != told.npos,
      "a swapped key is not shown beside the one that is trusted: " + told);
  std::string said;
  trial.check(!bed.order("engage: true", &said), "engaged with a swapped key");
  bed.signal(Who::kSlave, "TERM");
  bed.wait(kSecond);
  bed.use_keys(Who::kSlave, own);
  if (const Status started = bed.start(Who::kSlave); !started) bed.problem(started.message());
  trial.check(bed.over() || bed.engage(30 * kSecond), "cannot be engaged with the right key again");
}

}  // namespace

RowResult x4(const RowRun& run) {
  const int count = run.full ? 100'000 : 20'000;
  Trial trial(
      run,
      "forged states, alerts, handshakes and plain stops and resets from the master's address "
      "and the slave's, in the present session; then another key at the slave's place",
      "no effect: led throughout; both keys shown, no session with the other");
  BedOptions whole;
  whole.tap_bytes = 1500;
  auto bed = trial.bed(whole);
  if (!bed) return trial.result();
  bed->drive(500 * kMillisecond);
  const auto seen = overheard(*bed);
  if (!seen) {
    bed->problem(seen.message());
    (void)trial.end(std::move(bed));
    return trial.result();
  }
  Random random(run.seed ^ 0xf0c9edULL);
  Codec codec;
  const std::array<std::string, 3> paths = {bed->folder() + "/to-slave.pcap",
                                            bed->folder() + "/to-master.pcap",
                                            bed->folder() + "/plain.pcap"};
  for (const Status& made :
       {write_packets(paths[0], count, [&](int i) { return forgery(random, *seen, true, i); }),
        write_packets(paths[1], count, [&](int i) { return forgery(random, *seen, false, i); }),
        write_packets(paths[2], count / 10, [&](int i) { return plain(codec, *seen, i); })}) {
    if (!made) bed->problem(made.message());
  }
  send_all(*bed, "far", paths[0], count, 10'000);
  send_all(*bed, "near", paths[1], count, 10'000);
  send_all(*bed, "far", paths[2], count / 10, 10'000);
  trial.check(bed->over() || bed->led(), "not led any more");
  const std::string log = bed->printed(Who::kSlave);
  trial.check(count_of(log, "session ended") == 0, "the session ended");
  swap_key(trial, *bed);
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  return trial.result();
}

RowResult x5(const RowRun& run) {
  Trial trial(run, "junk to the slave's port, 20 000 and 100 000 datagrams a second",
              "at 20 000 no gap beside the machine's and led; 0 accepted of the junk; above, the "
              "session lives and is led again");
  const double seconds = run.full ? 60.0 : 5.0;
  for (const int rate : {20'000, 100'000}) {
    auto bed = trial.bed();
    if (!bed) return trial.result();
    double before = 0.0, after = 0.0;
    bed->drive(2 * kSecond, [&](const pb::Status& s) { before = s.loop_lateness_us().p999(); });
    const auto done = bed->emulator(
        fmt::format("flood far 192.0.2.9:4000 {} {} {} 200", kSlaveAt, rate, seconds));
    if (!done) bed->problem(done.message());
    bed->drive(from_seconds(seconds + 1.0),
               [&](const pb::Status& s) { after = s.loop_lateness_us().p999(); });
    const bool led = bed->led() || (rate > 20'000 && bed->engage());
    const BedVerdict verdict = trial.end(std::move(bed));
    judge_acceptance(trial, verdict);
    trial.measure(
        fmt::format("{}/s: {} rejected, {} gaps beside the machine's, haptic loop late p99.9 "
                    "{:.0f} us before and {:.0f} with it",
                    rate, verdict.rejected.value_or(0), verdict.link.trips, before, after));
    trial.check(trial.over() || led, fmt::format("{}/s: not led", rate));
    if (rate > 20'000) continue;
    trial.check(verdict.link.trips == 0, fmt::format("{}/s: a gap", rate));
  }
  return trial.result();
}

}  // namespace handrail::faults::rows
