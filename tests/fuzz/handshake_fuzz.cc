// Both ends of the encrypted link on a network that loses, repeats, reorders, cuts, changes and
// makes up datagrams, while keys and lists change. The input is a row of acts, each a byte and what
// it needs.
#include <malloc.h>
#include <openssl/crypto.h>

#include <cstdlib>
#include <random>
#include <set>

#include "tests/fuzz/fixed_random.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/made_up_net/made_up_net.h"

namespace handrail {
namespace {

using fuzz::require;
using test::Bytes;

// What OpenSSL holds at present. Counted from the program's start on, or not at all.
std::size_t held_bytes = 0;
void* count_malloc(std::size_t size, const char*, int) {
  void* out = std::malloc(size);
  held_bytes += out == nullptr ? 0 : ::malloc_usable_size(out);
  return out;
}
void* count_realloc(void* old, std::size_t size, const char*, int) {
  const std::size_t before = old == nullptr ? 0 : ::malloc_usable_size(old);
  void* out = std::realloc(old, size);
  if (out != nullptr || size == 0)
    held_bytes += (out == nullptr ? 0 : ::malloc_usable_size(out)) - before;
  return out;
}
void count_free(void* old, const char*, int) {
  if (old != nullptr) held_bytes -= ::malloc_usable_size(old);
  std::free(old);
}
const bool counted = CRYPTO_set_mem_functions(count_malloc, count_realloc, count_free) == 1;

// Twelve channels at most (a slot each, one that listens, three of the client), each with its
// buffers, a message of a handshake put together from fragments, which OpenSSL takes up to 100 kB
// of, and the records that come before their keys: a hundred at most, each with a buffer of 17 kB
// (dtls1_buffer_record in its ssl/record).
constexpr std::size_t kMostHeld = 12 * (200 + 100 * 17) * 1024;

// Told at the program's end: a fuzzer's own figure counts sessions.
std::uint64_t crowded = 0;
#ifdef HANDRAIL_FUZZER
const bool told = std::atexit([] {
                    std::fprintf(stderr, "stat::changed_datagrams: %llu\n",
                                 static_cast<unsigned long long>(crowded));
                  }) == 0;
#endif

class Link {
 public:
  explicit Link(fuzz::Bytes bytes) : in_(bytes) {
    pair_.net.passes = [this](test::MadeUpNet::Datagram& datagram) {
      if (honest_) return true;
      if (waiting_.size() == kMostWaiting) waiting_.erase(waiting_.begin());
      waiting_.push_back(datagram);
      return false;
    };
  }

  void run() {
    const std::size_t before = held_bytes;
    for (int acts = 0; !in_.empty() && acts < kMostActs; ++acts) {
      act(in_.take<std::uint8_t>());
      check();
      require(!counted || held_bytes - std::min(before, held_bytes) < kMostHeld,
              "memory is bounded");
    }
    // Whatever it was, two that trust each other come together again.
    honest_ = true;
    trust(3);
    (void)pair_.slave.set_own(pair_.slave_key, std::nullopt);
    (void)pair_.master.set_own(pair_.master_key, std::nullopt);
    const std::size_t got = pair_.slave_got.size();
    for (int ms = 0; ms < kMostMs && (ms < 20 || pair_.slave_got.size() == got); ++ms) {
      say(1);
      pair_.step();
      pair_.net.sent.clear();
    }
    check();
    require(pair_.slave_got.size() > got, "the link comes back");
  }

 private:
  static constexpr int kMostActs = 200, kMostMs = 8000, kCrowd = 2000, kMostCrowds = 4;
  static constexpr std::size_t kMostWaiting = 48;

  void act(std::uint8_t what) {
    switch (what % 10) {
      case 0: pass(Nanos{1} << in_.take<std::uint8_t>() % 33); break;  // up to 8 s
      case 1: pair_.step(); break;
      case 2: deliver([](Bytes&) {}); break;
      case 3:
        deliver([this](Bytes& bytes) {
          for (int i = in_.take<std::uint8_t>() % 4; i >= 0; --i) {
            bytes[in_.take<std::uint16_t>() % bytes.size()] = in_.take<std::uint8_t>();
          }
        });
        if (what >= 128) crowd(what);
        break;
      case 4:
        deliver([this](Bytes& bytes) { bytes.resize(in_.take<std::uint16_t>() % bytes.size()); });
        break;
      case 5: {  // two in one datagram
        const Bytes tail = any_bytes();
        deliver([&](Bytes& bytes) { bytes.insert(bytes.end(), tail.begin(), tail.end()); });
        break;
      }
      case 6: {
        const auto place = in_.take<std::uint8_t>();
        const auto made_up = in_.take_bytes(in_.take<std::uint16_t>() % 2100);
        const bool to_slave = (place & 1) != 0;
        const auto& slave = pair_.slave_socket.own();
        const auto& master = pair_.master_socket.own();
        const Address from = (place & 2) != 0 ? test::address_of(3, 7) : to_slave ? master : slave;
        pair_.net.put({from, to_slave ? slave : master, Bytes(made_up.begin(), made_up.end())});
        break;
      }
      case 7:
        honest_ = true;
        for (int i = what / 10 % 8; i >= 0; --i) pair_.step();
        honest_ = false;
        break;
      case 8: say(what); break;
      default: change(in_.take<std::uint8_t>());
    }
    pair_.net.sent.clear();
  }
  void pass(Nanos time) {
    pair_.now += time;
    test::wall_clock += time;
    pair_.step();
  }
  const test::MadeUpNet::Datagram* any() {
    const auto which = in_.take<std::uint8_t>();
    return waiting_.empty() ? nullptr : &waiting_[which % waiting_.size()];
  }
  Bytes any_bytes() {
    const auto* datagram = any();
    return datagram == nullptr ? Bytes() : datagram->bytes;
  }
  template <typename Change>
  void deliver(Change damage) {
    const auto* found = any();
    if (found == nullptr) return;
    auto datagram = *found;
    damage(datagram.bytes);
    if (datagram.bytes.size() > 2048) datagram.bytes.resize(2048);
    if ((in_.take<std::uint8_t>() & 15) == 15) datagram.from = test::address_of(9, 9);
    pair_.net.put(std::move(datagram));
  }
  // A handshake costs more than hundreds of datagrams that are not of it, and each of those is an
  // input to both ends: one that waits, changed in so many ways, at any stage.
  void crowd(std::uint8_t what) {
    if (waiting_.empty() || ++crowds_ > kMostCrowds) return;
    std::minstd_rand dice(what + 256u * static_cast<unsigned>(in_.left()));
    const auto below = [&dice](std::size_t end) { return dice() % end; };
    for (int i = 0; i < kCrowd; ++i) {
      auto datagram = waiting_[below(waiting_.size())];
      Bytes& bytes = datagram.bytes;
      for (std::size_t n = below(4); n > 0; --n) {
        // As often in the head of a record and of a handshake's message as in all the rest.
        const std::size_t end =
            below(2) == 0 ? std::min<std::size_t>(25, bytes.size()) : bytes.size();
        bytes[below(end)] = static_cast<std::uint8_t>(below(256));
      }
      if (below(8) == 0) bytes.resize(1 + below(bytes.size()));
      if (below(16) == 0) datagram.from = test::address_of(9, 9);
      pair_.net.put(std::move(datagram));
      ++crowded;
    }
    pair_.step();
  }
  void say(std::uint8_t what) {
    ++said_;
    const Bytes bytes(100, static_cast<std::uint8_t>(said_));
    (void)((what & 16) != 0 ? pair_.slave.send(bytes) : pair_.master.send(bytes));
  }
  void trust(std::uint8_t which) {
    const OwnKey& stranger = pair_.master_key;
    pair_.slave.set_trusted(
        test::trusting({{"desk", Role::kMaster,
                         ((which & 1) != 0 ? pair_.master_key : pair_.slave_key).public_key(),
                         (which & 4) != 0 ? std::optional(next_.public_key()) : std::nullopt}}));
    pair_.master.set_trusted(test::trusting(
        {{"cell", Role::kSlave, ((which & 2) != 0 ? pair_.slave_key : stranger).public_key(),
          (which & 8) != 0 ? std::optional(next_.public_key()) : std::nullopt}}));
  }
  void change(std::uint8_t what) {
    const std::optional<OwnKey> next = (what & 16) != 0 ? std::optional(next_) : std::nullopt;
    if ((what & 32) != 0) (void)pair_.slave.set_own(pair_.slave_key, next);
    if ((what & 64) != 0) (void)pair_.master.set_own(pair_.master_key, next);
    if ((what & 128) != 0) trust(what);
  }
  void check() {
    for (const auto* got : {&pair_.slave_got, &pair_.master_got}) {
      for (const Bytes& bytes : *got) {
        require(bytes.size() == 100 && std::set(bytes.begin(), bytes.end()).size() == 1,
                "what arrives was said by the other end");
      }
      require(got->size() <= said_, "and once");
    }
    const DtlsChannel* leader = pair_.slave.leader();
    require(leader == nullptr || pair_.slave_context->trusts(leader->peer().key),
            "who leads is trusted");
    const DtlsChannel* session = pair_.master.session();
    require(session == nullptr || pair_.master_context->trusts(session->peer().key),
            "so is who is called");
    (void)pair_.slave.take_begun();
    (void)pair_.master.take_begun();
  }

  fuzz::Input in_;
  std::vector<test::MadeUpNet::Datagram> waiting_;
  test::SecurePair pair_;
  const OwnKey next_ = *OwnKey::generate();
  bool honest_ = false;
  std::size_t said_ = 0;
  int crowds_ = 0;
};

}  // namespace

HANDRAIL_FUZZ(handshake) {
  fuzz::fix_random();
  Link(bytes).run();
}

}  // namespace handrail
