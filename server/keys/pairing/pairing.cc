#include "server/keys/pairing/pairing.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/plain_text.h"

#ifdef OPENSSL_NO_SRP
#error "Pairing needs an OpenSSL with SRP, as Debian's; this one was built without (no-srp)"
#endif

namespace handrail {
namespace {

// No certificate, no other key exchange, so nobody can offer one without the code.
constexpr char kCipher[] = "SRP-AES-256-CBC-SHA:@SECLEVEL=2";
// Who a code belongs to is no secret and the same everywhere.
char user_name[] = "handrail";
// Of RFC 5054, appendix A: 3072 bits, 128 bits of security. OpenSSL has no other group there.
constexpr char kGroup[] = "3072";
constexpr int kGroupBits = 3072;

constexpr char kKeyWord[] = "key ", kAgreed[] = "agreed", kRefused[] = "refused ";
constexpr char kAgain[] =
    ": a code is good for one guess; run `handrail keys pair` on both sides again";
constexpr char kExpected[] = "expected `handrail keys pair` of this version at the other side";

// OpenSSL 3 calls its SRP deprecated, and has nothing in its place.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

// Without it a server has no suite of SRP. What the code gives was set before.
int any_user(SSL*, int*, void*) { return SSL_ERROR_NONE; }

bool set_code(SSL_CTX* context, bool listens, std::string digits) {
  if (listens) return SSL_CTX_set_srp_username_callback(context, any_user) == 1;
  return SSL_CTX_set_srp_username(context, user_name) == 1 &&
         SSL_CTX_set_srp_password(context, digits.data()) == 1 &&
         SSL_CTX_set_srp_strength(context, kGroupBits) == 1;
}
bool set_verifier(SSL* ssl, const std::string& digits) {
  return SSL_set_srp_server_param_pw(ssl, user_name, digits.c_str(), kGroup) == 1;
}

#pragma GCC diagnostic pop

}  // namespace

Pairing::Pairing(Side side, Trusted own, Book book)
    : side_(side), own_(std::move(own)), book_(std::move(book)) {}

Pairing::~Pairing() {
  SSL_free(ssl_);
  SSL_CTX_free(context_);
}

Result<std::unique_ptr<Pairing>> Pairing::make(Side side, const PairingCode& code, Trusted own,
                                               Book book) {
  std::unique_ptr<Pairing> out(new Pairing(side, std::move(own), std::move(book)));
  const Status opened = out->open(code);
  ERR_clear_error();
  if (!opened) return opened;
  if (side == Side::kCalls) out->shake_hands();
  return out;
}

Status Pairing::open(const PairingCode& code) {
  Status failed = Status::error("pairing: OpenSSL cannot be set up");
  const bool listens = side_ == Side::kListens;
  context_ = SSL_CTX_new(listens ? TLS_server_method() : TLS_client_method());
  if (context_ == nullptr) return failed;
  const bool set = SSL_CTX_set_min_proto_version(context_, TLS1_2_VERSION) == 1 &&
                   SSL_CTX_set_max_proto_version(context_, TLS1_2_VERSION) == 1 &&
                   SSL_CTX_set_cipher_list(context_, kCipher) == 1 &&
                   set_code(context_, listens, code.digits());
  SSL_CTX_set_options(context_, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_session_cache_mode(context_, SSL_SESS_CACHE_OFF);
  ssl_ = set ? SSL_new(context_) : nullptr;
  BIO* in = ssl_ == nullptr ? nullptr : BIO_new(BIO_s_mem());
  BIO* out = in == nullptr ? nullptr : BIO_new(BIO_s_mem());
  if (out == nullptr) {
    BIO_free(in);
    return failed;
  }
  SSL_set_bio(ssl_, in, out);
  listens ? SSL_set_accept_state(ssl_) : SSL_set_connect_state(ssl_);
  return !listens || set_verifier(ssl_, code.digits()) ? Status::ok() : failed;
}

void Pairing::take(std::span<const std::uint8_t> bytes) {
  if (over() || bytes.empty()) return;
  guessed_ = guessed_ || answered_;
  heard_ += bytes.size();
  if (heard_ > kMostBytes) {
    return finish(Status::error("the other side sends more than " + std::to_string(kMostBytes) +
                                " bytes: " + kExpected));
  }
  BIO_write(SSL_get_rbio(ssl_), bytes.data(), static_cast<int>(bytes.size()));
  if (stage_ == Stage::kHandshake) shake_hands();
  read_lines();
}

void Pairing::end() {
  if (over()) return;
  const bool calls = side_ == Side::kCalls;
  if (stage_ == Stage::kVerdict && calls) {
    return finish(Status::error(
        "the other side ended before it said whether it trusts this key now: `handrail keys list` "
        "says so there; nothing was changed here"));
  }
  if (heard_ == 0) {
    return finish(Status::error(
        calls ? "the other side ended the connection before it said anything: its minute is over, "
                "or it has paired with another"
              : "ended the connection before it said anything"));
  }
  finish(
      Status::error("the other side ended the connection in the middle of the pairing; nothing "
                    "was changed here"));
}

std::vector<std::uint8_t> Pairing::give() {
  std::vector<std::uint8_t> out(BIO_ctrl_pending(SSL_get_wbio(ssl_)));
  if (out.empty()) return out;
  BIO_read(SSL_get_wbio(ssl_), out.data(), static_cast<int>(out.size()));
  answered_ = answered_ || !over();
  return out;
}

void Pairing::shake_hands() {
  ERR_clear_error();
  const int done = SSL_do_handshake(ssl_);
  const int error = SSL_get_error(ssl_, done);
  if (done == 1) {
    stage_ = Stage::kKey;
    say(kKeyWord + line_text(own_));
  } else if (error != SSL_ERROR_WANT_READ && error != SSL_ERROR_WANT_WRITE) {
    finish(broken_handshake());
  }
  ERR_clear_error();
}

Status Pairing::broken_handshake() const {
  const int reason = ERR_GET_REASON(ERR_peek_error());
  const bool wrong_code = reason == SSL_R_DECRYPTION_FAILED_OR_BAD_RECORD_MAC ||
                          reason == SSL_R_SSLV3_ALERT_BAD_RECORD_MAC ||
                          reason == SSL_R_DIGEST_CHECK_FAILED || reason == SSL_R_BAD_SRP_A_LENGTH;
  if (side_ == Side::kListens && guessed_) {
    return Status::error(std::string("the other side gave a wrong code, or none") + kAgain);
  }
  if (side_ == Side::kCalls && wrong_code) {
    return Status::error(std::string("the code is wrong") + kAgain);
  }
  return Status::error(std::string("the other side does not pair: ") + kExpected);
}

void Pairing::read_lines() {
  while (!over() && stage_ != Stage::kHandshake) {
    std::array<char, kLongestLine> buffer;
    ERR_clear_error();
    const int size = SSL_read(ssl_, buffer.data(), static_cast<int>(buffer.size()));
    if (size <= 0) {
      const int error = SSL_get_error(ssl_, size);
      ERR_clear_error();
      if (error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE) return;
      if (error == SSL_ERROR_ZERO_RETURN) return end();
      return finish(Status::error("what the other side sent was changed on its way"));
    }
    for (const char c : std::span(buffer).first(static_cast<std::size_t>(size))) {
      if (over()) return;
      if (c == '\n') {
        on_line(std::exchange(line_, {}));
      } else if (line_.size() == kLongestLine) {
        return refuse("a line of over " + std::to_string(kLongestLine) + " bytes: " + kExpected);
      } else {
        line_ += c;
      }
    }
  }
}

void Pairing::on_line(const std::string& line) {
  if (line.starts_with(kRefused)) {
    return finish(Status::error("the other side refuses: " +
                                shown(line.substr(sizeof(kRefused) - 1), kLongestLine)));
  }
  if (stage_ == Stage::kKey && line.starts_with(kKeyWord)) {
    return on_key(line.substr(sizeof(kKeyWord) - 1));
  }
  if (stage_ == Stage::kVerdict && line == kAgreed) return on_agreed();
  refuse(std::string("what comes out of turn, '").append(shown(line)).append("': ") + kExpected);
}

void Pairing::on_key(const std::string& text) {
  const auto entry = parse_entry(text);
  if (!entry) return refuse(entry.message());
  other_ = *entry;
  told_ = true;
  if (same_keys(own_, other_)) return refuse("both sides show the same key: pair two computers");
  if (!meet(own_.roles, other_.roles)) {
    return refuse("a " + roles_text(own_.roles) + " has nothing to say to a " +
                  roles_text(other_.roles) +
                  ": expected a slave and a master, or a master and an operator or observer");
  }
  if (const Status fits = book_.check(other_); !fits) return refuse(fits.message());
  stage_ = Stage::kVerdict;
  if (side_ == Side::kCalls) say(kAgreed);
}

// The listening side keeps the key first and says so, then the other does: who cannot keep it is
// the last to say anything.
void Pairing::on_agreed() {
  if (const Status kept = book_.keep(other_); !kept) {
    if (side_ == Side::kListens) return refuse(kept.message());
    return finish(Status::error(kept.message() + "; the other side trusts this key already"));
  }
  if (side_ == Side::kListens) say(kAgreed);
  finish(Status::ok());
}

void Pairing::say(const std::string& line) {
  const std::string text = line + "\n";
  SSL_write(ssl_, text.data(), static_cast<int>(text.size()));
}

void Pairing::refuse(const std::string& why) {
  say(kRefused + shown(why, kLongestLine - sizeof(kRefused)));
  finish(Status::error(why));
}

void Pairing::finish(Status result) {
  stage_ = Stage::kOver;
  result_ = std::move(result);
}

}  // namespace handrail
