// Datagrams at both ends of an encrypted session that is open: as anybody makes them up, from the
// peer's address or another, and genuine ones, cut and changed. None is taken, and none ends the
// session, which stays open from one input to the next. The first byte chooses.
#include <algorithm>
#include <memory>
#include <set>

#include "tests/fuzz/fixed_random.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/made_up_net/made_up_net.h"

namespace handrail {
namespace {

using fuzz::require;
using test::Bytes;

class OpenLink {
 public:
  OpenLink() {
    require(pair_.connect() && pair_.say(kLost), "two that trust each other come together");
    pair_.slave_got.clear();
  }

  void hear(fuzz::Input in) {
    const auto how = in.take<std::uint8_t>();
    const bool at_slave = (how & 1) != 0;
    const auto& slave = pair_.slave_socket.own();
    const auto& master = pair_.master_socket.own();
    const Address peer = at_slave ? master : slave;
    const Address from = (how & 2) != 0 ? peer : test::address_of(3, 7);
    Bytes bytes = (how & 4) != 0 ? genuine(at_slave, in) : Bytes();
    if (bytes.empty()) {
      const auto made_up = in.take_bytes(2048);
      bytes.assign(made_up.begin(), made_up.end());
    }
    pair_.net.put({from, at_slave ? slave : master, std::move(bytes)});
    pair_.step();
    speak();
  }

 private:
  // Something that an end said but that did not come; then changed, so that it is not genuine.
  Bytes genuine(bool to_slave, fuzz::Input& in) {
    Bytes out;
    pair_.net.passes = [&out](test::MadeUpNet::Datagram& datagram) {
      out = datagram.bytes;
      return false;
    };
    (void)(to_slave ? pair_.master.send(kLost) : pair_.slave.send(kLost));
    pair_.net.passes = [](auto&) { return true; };
    require(!out.empty(), "an open session carries what is said");
    const Bytes before = out;
    for (int i = in.take<std::uint8_t>() % 4; i >= 0; --i) {
      out[in.take<std::uint16_t>() % out.size()] = in.take<std::uint8_t>();
    }
    const auto tail = in.take_bytes(in.take<std::uint8_t>());
    out.insert(out.end(), tail.begin(), tail.end());
    out.resize(std::min<std::size_t>(out.size(), in.take<std::uint16_t>() % 2048));
    return out == before ? Bytes() : out;
  }
  // Both ends get what the other says, once, and nothing else.
  void speak() {
    const Bytes said(100, ++said_);
    require(pair_.master.send(said) && pair_.slave.send(said), "the session is open");
    pair_.step();
    pair_.net.sent.clear();
    for (std::vector<Bytes>* got : {&pair_.slave_got, &pair_.master_got}) {
      require(got->size() == 1 && got->front() == said, "what was said comes, and nothing else");
      got->clear();
    }
  }

  static inline const Bytes kLost = Bytes(200, 0xee);
  test::SecurePair pair_;
  std::uint8_t said_ = 0;
};

}  // namespace

HANDRAIL_FUZZ(records) {
  fuzz::fix_random();
  static const auto link = std::make_unique<OpenLink>();
  link->hear(fuzz::Input(bytes));
}

}  // namespace handrail
