// Both ends of a pairing, with the same code or not, whose bytes come in pieces, changed, cut or
// made up; and an end that knows the code and says what it likes. The input is a byte of choices,
// what that end says as its name, and a row of acts.
#include "server/keys/pairing/pairing.h"

#include "server/base/plain_text.h"
#include "tests/fuzz/fixed_random.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

struct Side {
  Trusted own;
  bool takes = true;   // the other's key
  bool writes = true;  // ... into its list
  std::vector<Trusted> kept;
  std::unique_ptr<Pairing> pairing;
  std::vector<std::uint8_t> to_it;  // under way

  void begin(Pairing::Side side, const char* code) {
    Pairing::Book book{
        [this](const Trusted&) { return takes ? Status::ok() : Status::error("not taken"); },
        [this](const Trusted& entry) {
          if (!writes) return Status::error("not written");
          kept.push_back(entry);
          return Status::ok();
        }};
    pairing = std::move(*Pairing::make(side, *PairingCode::parse(code), own, std::move(book)));
  }
};

class Two {
 public:
  explicit Two(fuzz::Bytes bytes) : in_(bytes) {
    const auto choices = in_.take<std::uint8_t>();
    same_code_ = (choices & 1) == 0;
    listens_.own = {"cell", (choices & 2) != 0 ? Role::kMaster : Role::kSlave, key(1)};
    calls_.own = {"desk", Role::kMaster, key(2)};
    listens_.takes = (choices & 4) == 0;
    calls_.writes = (choices & 8) == 0;
    listens_.writes = (choices & 16) == 0;
    speaker_ = (choices & 32) != 0 ? &listens_ : &calls_;
    if ((choices & 64) != 0) {
      free_speech_ = true;
      speaker_->own.name = fuzz::text_of(in_.take_bytes(in_.take<std::uint16_t>() % 2048));
    }
    listens_.begin(Pairing::Side::kListens, "4829137");
    calls_.begin(Pairing::Side::kCalls, same_code_ ? "482-9137" : "4829138");
  }

  void run() {
    for (int acts = 0; !in_.empty() && acts < kMostActs; ++acts) act(in_.take<std::uint8_t>());
    // The rest arrives as it is, and then both connections end.
    for (int i = 0; i < 8; ++i) {
      carry(listens_, 100000);
      carry(calls_, 100000);
    }
    listens_.pairing->end();
    calls_.pairing->end();
    check();
    require(listens_.pairing->over() && calls_.pairing->over(), "it ends with its connection");
    require(calls_.kept.empty() || !listens_.kept.empty() || free_speech_,
            "a caller keeps a key when the listener has");
  }

 private:
  static constexpr int kMostActs = 60;

  static PublicKey key(std::uint8_t which) {
    PublicKey out;
    out.bytes[0] = 2;
    out.bytes[1] = which;
    return out;
  }
  Side& side(std::uint8_t which) { return (which & 1) != 0 ? listens_ : calls_; }
  Side& other(Side& one) { return &one == &listens_ ? calls_ : listens_; }

  void collect() {
    for (Side* one : {&listens_, &calls_}) {
      const auto bytes = one->pairing->give();
      require(bytes.size() < 8192, "an end says little at once");
      auto& to = other(*one).to_it;
      to.insert(to.end(), bytes.begin(), bytes.end());
    }
  }
  void carry(Side& to, std::size_t most) {
    collect();
    const std::size_t size = std::min(most, to.to_it.size());
    to.pairing->take(std::span(to.to_it).first(size));
    to.to_it.erase(to.to_it.begin(), to.to_it.begin() + static_cast<std::ptrdiff_t>(size));
  }
  void act(std::uint8_t what) {
    Side& to = side(what);
    collect();
    const auto at = [&] { return to.to_it.begin() + in_.take<std::uint16_t>() % to.to_it.size(); };
    switch (what / 2 % 6) {
      case 0: carry(to, 100000); break;
      case 1: carry(to, in_.take<std::uint8_t>()); break;
      case 2:
        if (!to.to_it.empty())
          *at() ^= static_cast<std::uint8_t>(1u << in_.take<std::uint8_t>() % 8);
        break;
      case 3:
        if (!to.to_it.empty()) to.to_it.erase(at(), to.to_it.end());
        break;
      case 4: {
        const auto made_up = in_.take_bytes(in_.take<std::uint16_t>() % 20000);
        to.to_it.insert(to.to_it.end(), made_up.begin(), made_up.end());
        break;
      }
      default: to.pairing->end();
    }
    check();
  }
  void check() const {
    for (const auto& [one, from] : {std::pair{&listens_, &calls_}, {&calls_, &listens_}}) {
      require(one->kept.size() <= 1, "a key is kept once");
      if (!one->kept.empty()) {
        require(same_code_, "without the code no key is kept");
        require(listens_.takes || one != &listens_, "nor one that cannot be taken");
        const bool as_told = one->kept[0] == from->own || (free_speech_ && speaker_ == from);
        require(as_told, "a key is kept as the other end has told it");
        require(meet(one->own.roles, one->kept[0].roles), "and one of a role that fits");
        require(!same_keys(one->own, one->kept[0]), "and none of one's own");
      }
      const Pairing& pairing = *one->pairing;
      require(same_code_ || pairing.other() == nullptr, "without the code no key is told");
      if (!pairing.over()) continue;
      if (pairing.result()) {
        require(one->kept.size() == 1, "who has paired has kept a key");
      } else {
        require(is_plain_text(pairing.result().message()), "an error is plain text");
        require(pairing.result().message().size() < 1200, "and no essay");
      }
    }
  }

  fuzz::Input in_;
  bool same_code_ = true, free_speech_ = false;
  Side listens_, calls_;
  Side* speaker_ = nullptr;
};

}  // namespace

HANDRAIL_FUZZ(pairing) {
  fuzz::fix_random();
  Two(bytes).run();
}

}  // namespace handrail
