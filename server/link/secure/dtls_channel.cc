#include "server/link/secure/dtls_channel.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <new>

#include "server/base/time.h"
#include "server/link/codec.h"
#include "server/link/secure/record.h"

namespace handrail {

// What OpenSSL reads from and writes to, in place of a socket.
struct DtlsWire {
  static DtlsChannel& channel(BIO* bio) { return *static_cast<DtlsChannel*>(BIO_get_data(bio)); }

  static int read(BIO* bio, char* out, int size) {
    DtlsChannel& self = channel(bio);
    BIO_clear_retry_flags(bio);
    if (self.waiting_.empty()) {
      BIO_set_retry_read(bio);
      return -1;
    }
    // A datagram is read as a whole: what does not fit is gone, as with a socket.
    const std::size_t count = std::min(self.waiting_.size(), static_cast<std::size_t>(size));
    std::copy_n(self.waiting_.begin(), count, reinterpret_cast<std::uint8_t*>(out));
    if (!self.peek_) self.waiting_ = {};
    return static_cast<int>(count);
  }

  static int write(BIO* bio, const char* bytes, int size) {
    DtlsChannel& self = channel(bio);
    BIO_clear_retry_flags(bio);
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes);
    // What the socket does not take is a lost datagram, which DTLS is made for.
    self.sent_ = self.socket_.send({data, static_cast<std::size_t>(size)}, self.attached_.address);
    return size;
  }

  static long control(BIO* bio, int what, long number, void*) {
    switch (what) {
      case BIO_CTRL_FLUSH: return 1;
      case BIO_CTRL_DGRAM_SET_PEEK_MODE: channel(bio).peek_ = number != 0; return 1;
      case BIO_CTRL_DGRAM_QUERY_MTU:
      case BIO_CTRL_DGRAM_GET_FALLBACK_MTU: return kLongestHandshake;
      default: return 0;
    }
  }

  static int create(BIO* bio) {
    BIO_set_init(bio, 1);
    return 1;
  }

  static const BIO_METHOD* method() {
    static BIO_METHOD* const made = [] {
      BIO_METHOD* out = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "handrail link");
      BIO_meth_set_read(out, read);
      BIO_meth_set_write(out, write);
      BIO_meth_set_ctrl(out, control);
      BIO_meth_set_create(out, create);
      return out;
    }();
    return made;
  }
};

namespace {

// After `before` [us], 0 at a flight's first. OpenSSL counts how often, but does not say: the last
// digits do.
unsigned int retransmit_us(SSL*, unsigned int before) {
  constexpr auto kFirst = static_cast<unsigned int>(DtlsChannel::kRetransmit / kMicrosecond);
  constexpr auto kLast = static_cast<unsigned int>(DtlsChannel::kSlowestRetransmit / kMicrosecond);
  if (before < kFirst) return kFirst;
  if (before < kFirst + DtlsChannel::kQuickRetransmits - 1) return before + 1;
  return std::min(2 * (before / kFirst * kFirst), kLast);
}

// Other than by forging, nobody who is let in sends more in one datagram than a link's datagram.
constexpr std::size_t kScratch = kMaxDatagram + 1;

}  // namespace

std::unique_ptr<DtlsChannel> DtlsChannel::make(const SecureContext& context, DatagramSocket& socket,
                                               const Address& peer,
                                               SecureContext::Own own) noexcept {
  return std::unique_ptr<DtlsChannel>(new (std::nothrow) DtlsChannel(context, socket, peer, own));
}

DtlsChannel::DtlsChannel(const SecureContext& context, DatagramSocket& socket, const Address& peer,
                         SecureContext::Own own) noexcept
    : context_(context), socket_(socket), ssl_(SSL_new(context.get())) {
  attached_.address = peer;
  BIO* wire = ssl_ == nullptr ? nullptr : BIO_new(DtlsWire::method());
  if (wire == nullptr) {
    problem_ = Problem::kNoAgreement;
    return;
  }
  BIO_set_data(wire, this);
  SSL_set_bio(ssl_, wire, wire);
  SSL_set_mtu(ssl_, kLongestHandshake);
  SecureContext::attach(ssl_, &attached_);
  if (!context.show(ssl_, own)) {
    problem_ = Problem::kNoAgreement;
    return;
  }
  DTLS_set_timer_cb(ssl_, retransmit_us);
  const bool client = context.side() == SecureContext::Side::kClient;
  client ? SSL_set_connect_state(ssl_) : SSL_set_accept_state(ssl_);
  state_ = client ? State::kHandshake : State::kListening;
}

DtlsChannel::~DtlsChannel() {
  close();
  SSL_free(ssl_);
}

bool DtlsChannel::listen(std::span<const std::uint8_t> datagram, const Address& from) noexcept {
  if (state_ != State::kListening) return false;
  waiting_ = datagram;
  attached_.address = from;
  ERR_clear_error();
  static BIO_ADDR* const unused = BIO_ADDR_new();  // where it would say what `from` says
  const int heard = DTLSv1_listen(ssl_, unused);
  if (heard == 1) {
    state_ = State::kHandshake;
    peek_ = false;
    go_on();
  }
  waiting_ = {};
  return heard == 1;
}

std::size_t DtlsChannel::take(std::span<const std::uint8_t> datagram, const Address& from,
                              std::span<std::uint8_t> plain) noexcept {
  // Once the version is agreed, OpenSSL passes over the head of a record of another version and
  // takes its body for records (dtls1_get_record in its ssl/record), so that is_records() has not
  // seen them.
  const bool agreed = state_ == State::kOpen || SSL_is_server(ssl_) == 1;
  if (agreed && is_before_version(datagram)) return 0;
  if (state_ == State::kOpen && is_data(datagram)) {
    const std::size_t size = is_one_data(datagram) ? opener_.open(datagram, plain) : 0;
    if (size != 0) from_ = from;
    return size;
  }
  waiting_ = datagram;
  if (state_ == State::kHandshake) go_on();
  if (state_ == State::kOpen) {
    // What is no data: an alert, the handshake's last flight again. What else it may hold counts as
    // lost.
    std::array<std::uint8_t, kScratch> none;
    for (int i = 0; i < 64; ++i) {
      ERR_clear_error();
      const int size = SSL_read(ssl_, none.data(), static_cast<int>(none.size()));
      if (size > 0) continue;
      end(size);
      break;
    }
  }
  waiting_ = {};
  return 0;
}

bool DtlsChannel::send(std::span<const std::uint8_t> plain) noexcept {
  if (state_ != State::kOpen) return false;
  sent_ = false;
  ERR_clear_error();
  const int size = SSL_write(ssl_, plain.data(), static_cast<int>(plain.size()));
  if (size <= 0) end(size);
  return size > 0 && sent_;
}

void DtlsChannel::tick() noexcept {
  if (state_ != State::kHandshake) return;
  if (SSL_in_before(ssl_) == 1) return go_on();
  ERR_clear_error();
  if (DTLSv1_handle_timeout(ssl_) < 0) {
    state_ = State::kClosed;
    problem_ = Problem::kNoAnswer;
  }
}

void DtlsChannel::close() noexcept {
  if (state_ == State::kOpen) {
    ERR_clear_error();
    (void)SSL_shutdown(ssl_);
  }
  state_ = State::kClosed;
}

void DtlsChannel::go_on() noexcept {
  ERR_clear_error();
  const int result = SSL_do_handshake(ssl_);
  if (result == 1) {
    const bool opens = opener_.begin(ssl_);
    state_ = opens ? State::kOpen : State::kClosed;
    if (!opens) problem_ = Problem::kNoAgreement;
  } else {
    end(result);
  }
}

void DtlsChannel::end(int result) noexcept {
  const int error = SSL_get_error(ssl_, result);
  if (error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE) return;
  const bool in_order = error == SSL_ERROR_ZERO_RETURN;
  const bool handshaking = state_ == State::kHandshake;
  state_ = State::kClosed;
  if (in_order) return;
  const int reason = ERR_GET_REASON(ERR_peek_error());
  if (handshaking && attached_.peer.shown && !attached_.peer.trusted) {
    problem_ = Problem::kUntrusted;
  } else if (reason == SSL_R_SSLV3_ALERT_BAD_CERTIFICATE) {
    problem_ = Problem::kWeAre;
  } else if (reason == SSL_R_READ_TIMEOUT_EXPIRED) {
    problem_ = Problem::kNoAnswer;
  } else {
    problem_ = Problem::kNoAgreement;
  }
}

}  // namespace handrail
