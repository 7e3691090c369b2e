// Two ends of a pairing, and what each has kept.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "server/keys/own_key.h"
#include "server/keys/pairing/pairing.h"

namespace handrail {

inline PairingCode code_of(const std::string& digits) { return *PairingCode::parse(digits); }

// One side: its entry, and a book that keeps what it is told.
struct PairingEnd {
  PairingEnd(const std::string& name, Roles roles)
      : own{name, roles, OwnKey::generate()->public_key()} {}

  Pairing::Book book() {
    return {[this](const Trusted&) { return check; },
            [this](const Trusted& entry) {
              if (keep) kept.push_back(entry);
              return keep;
            }};
  }
  void begin(Pairing::Side side, const std::string& digits) {
    pairing = std::move(*Pairing::make(side, code_of(digits), own, book()));
  }

  Trusted own;
  Status check = Status::ok(), keep = Status::ok();
  std::vector<Trusted> kept;
  std::unique_ptr<Pairing> pairing;
};

// Carries bytes to and fro, `step` at a time, until neither has more to say; returns how many.
inline std::size_t converse(Pairing& a, Pairing& b, std::size_t step = 100000) {
  std::size_t carried = 0;
  const auto carry = [&](Pairing& from, Pairing& to) {
    const auto bytes = from.give();
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      to.take(std::span(bytes).subspan(at, std::min(step, bytes.size() - at)));
    }
    carried += bytes.size();
    return !bytes.empty();
  };
  for (bool some = true; some;) {
    const bool there = carry(a, b);
    some = carry(b, a) || there;
  }
  return carried;
}

}  // namespace handrail
