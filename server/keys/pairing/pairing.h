// One pairing of two computers, without sockets: bytes come in, bytes are to be sent.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <openssl/types.h>

#include "server/base/status.h"
#include "server/keys/pairing/pairing_code.h"
#include "server/keys/trust_list.h"

namespace handrail {

// Two ends that know the same code tell each other their keys (proto/WIRE.md, "Pairing"). It is
// TLS 1.2 with SRP-6a (RFC 5054), which OpenSSL does: a password-authenticated key exchange, in
// which who does not know the code learns nothing that it could try codes on afterwards, and each
// end proves the code to the other. What is said then is encrypted and authenticated by it. Not
// real-time safe. One thread at a time.
class Pairing {
 public:
  enum class Side : std::uint8_t { kListens, kCalls };
  // What is done with the other side's key. A message is also told to the other side.
  struct Book {
    std::function<Status(const Trusted&)> check;  // why it cannot be kept; changes nothing
    std::function<Status(const Trusted&)> keep;
  };
  // Bytes of the other side. A pairing has 1.5 kB each way; more is somebody else's.
  static constexpr std::size_t kMostBytes = 16 * 1024;
  static constexpr std::size_t kLongestLine = 512;  // bytes: a key's line has 170 at most

  // `own`: how we are to be trusted at the other side. A caller has something to send at once.
  static Result<std::unique_ptr<Pairing>> make(Side side, const PairingCode& code, Trusted own,
                                               Book book);
  ~Pairing();
  Pairing(const Pairing&) = delete;
  Pairing& operator=(const Pairing&) = delete;

  // Bytes of the other side, in any pieces.
  void take(std::span<const std::uint8_t> bytes);
  // The other side sends no more.
  void end();
  // What is to be sent now; also when it is over: the other side is told why.
  std::vector<std::uint8_t> give();

  bool over() const noexcept { return stage_ == Stage::kOver; }
  // When it is over: ok, both sides have kept the other's key; or why not.
  const Status& result() const noexcept { return result_; }
  // Somebody may have tried a code: the other side spoke after it had our answer to its first
  // words, without which no code can be tried. Such a code must not be used again.
  bool guessed() const noexcept { return guessed_; }
  // The other side's key, once it has proved the code and told it; null before.
  const Trusted* other() const noexcept { return told_ ? &other_ : nullptr; }

 private:
  enum class Stage : std::uint8_t {
    kHandshake,
    kKey,      // the other side's is awaited
    kVerdict,  // ... whether it takes ours
    kOver,
  };

  Pairing(Side side, Trusted own, Book book);
  Status open(const PairingCode& code);
  void shake_hands();
  void read_lines();
  void on_line(const std::string& line);
  void on_key(const std::string& text);
  void on_agreed();
  void say(const std::string& line);
  void finish(Status result);
  void refuse(const std::string& why);
  Status broken_handshake() const;

  Side side_;
  Trusted own_;
  Book book_;
  SSL_CTX* context_ = nullptr;
  SSL* ssl_ = nullptr;
  Stage stage_ = Stage::kHandshake;
  Status result_ = Status::error("the pairing has not ended");
  std::size_t heard_ = 0;  // bytes
  bool answered_ = false, guessed_ = false, told_ = false;
  std::string line_;  // as far as it has come
  Trusted other_;
};

}  // namespace handrail
