// handrail-faults-peer: who has a master's key and speaks the link's contract otherwise.
//
//   handrail-faults-peer KEYS HOST[:PORT] MS VARIANT...
//
// Opens the encrypted link with the key of folder KEYS and sends each variant for so many
// milliseconds, a thousand datagrams a second; then says how many of each. The slave says what it
// made of them.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio.hpp>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/version.h"
#include "server/link/codec.h"
#include "server/link/frame.h"
#include "server/link/secure/secure_transport.h"

namespace {

using namespace handrail;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kVersionAt = 4, kKindAt = 5;
constexpr std::uint16_t kLinkPort = 47002;
constexpr Nanos kPatience = 10 * kSecond;  // for a session

void reseal(Bytes& datagram) { seal_frame(static_cast<DatagramKind>(datagram[kKindAt]), datagram); }

const std::map<std::string, std::function<void(Bytes&)>>& variants() {
  static const std::map<std::string, std::function<void(Bytes&)>> all = {
      {"same", [](Bytes&) {}},
      {"older", [](Bytes& d) { d[kVersionAt] = kWireVersion - 1; }},
      {"newer", [](Bytes& d) { d[kVersionAt] = kWireVersion + 1; }},
      // Field 2000 as a varint, as a newer version might add one without saying so.
      {"field",
       [](Bytes& d) {
         d.insert(d.end(), {0x80, 0x7d, 0x01});
         reseal(d);
       }},
      {"kind", [](Bytes& d) { d[kKindAt] = 9; }},
      // Without its last byte, right in its length and checksum.
      {"short",
       [](Bytes& d) {
         d.pop_back();
         reseal(d);
       }},
  };
  return all;
}

// Sound, and wants nothing: what is refused of it is refused for its form.
Bytes sound(Codec& codec, std::uint64_t session, std::uint64_t sequence) {
  DatagramHeader header;
  header.session = session;
  header.sequence = sequence;
  header.sent = monotonic_now();
  Bytes out(kMaxDatagram);
  Reject cause = Reject::kNone;
  out.resize(codec.encode(header, MasterState(), out, cause));
  return out;
}

class Peer {
 public:
  Status open(const std::string& keys, const std::string& host) {
    const auto options = secure_options(KeyFolder(keys));
    if (!options) return options.status();
    const auto place = parse_host(host, kLinkPort);
    if (!place) return place.status();
    const auto link = calling_link(*options, *place);
    if (!link) return link.status();
    transport_ = (*link)(io_);
    if (Status opened = transport_->open(); !opened) return opened;
    const Nanos give_up = monotonic_now() + kPatience;
    while (transport_->identity(monotonic_now()).name.empty()) {
      if (monotonic_now() > give_up) {
        return Status::error("no session: " + transport_->identity(monotonic_now()).problem);
      }
      turn();
    }
    return Status::ok();
  }
  // A millisecond of its life.
  void turn() {
    io_.restart();  // it stops whenever it has nothing to wait for
    io_.poll();
    transport_->tick(monotonic_now());
    Bytes buffer(2048);
    while (transport_->receive(buffer)) ++heard_;
    sleep_until(next_ = std::max(next_ + kMillisecond, monotonic_now()));
  }
  int send_for(Nanos span, const std::function<void(Bytes&)>& change) {
    const Nanos until = monotonic_now() + span;
    int sent = 0;
    while (monotonic_now() < until) {
      Bytes datagram = sound(codec_, session_, ++sequence_);
      change(datagram);
      sent += transport_->send(datagram) ? 1 : 0;
      turn();
    }
    return sent;
  }
  std::uint64_t heard() const { return heard_; }

 private:
  boost::asio::io_context io_{1};
  std::unique_ptr<ServedTransport> transport_;
  Codec codec_;
  std::uint64_t session_ = static_cast<std::uint64_t>(monotonic_now());
  std::uint64_t sequence_ = 0, heard_ = 0;
  Nanos next_ = 0;
};

int run(const std::vector<std::string>& words) {
  if (words.size() < 4) {
    std::fputs("usage: handrail-faults-peer KEYS HOST[:PORT] MS VARIANT...\n", stderr);
    return 2;
  }
  Peer peer;
  if (const Status opened = peer.open(words[0], words[1]); !opened) {
    std::fprintf(stderr, "handrail-faults-peer: %s\n", opened.message().c_str());
    return 1;
  }
  for (std::size_t i = 3; i < words.size(); ++i) {
    const auto found = variants().find(words[i]);
    if (found == variants().end()) {
      std::fprintf(stderr, "handrail-faults-peer: '%s' is no variant\n", words[i].c_str());
      return 2;
    }
    const int sent = peer.send_for(std::atoi(words[2].c_str()) * kMillisecond, found->second);
    std::printf("%s=%d\n", words[i].c_str(), sent);
    std::fflush(stdout);
  }
  std::printf("DONE heard=%llu\n", static_cast<unsigned long long>(peer.heard()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-faults-peer", argc, argv)) return 0;
  return run({argv + 1, argv + argc});
}
