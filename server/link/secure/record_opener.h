// Opens the data records of an encrypted session.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <openssl/types.h>

#include "server/link/arrivals.h"

namespace handrail {

// Takes the place of OpenSSL's SSL_read for data, with the session's own key. OpenSSL drops a
// record that is 64 or more behind the newest as if it were repeated, and has no option for another
// window (dtls1_record_replay_check in its ssl/record). At a datagram a millisecond these are all
// that come 64 ms late, a quarter on a link of 50 +- 50 ms; the link, which tells late from lost,
// would take them for lost. Here each is opened once, as far behind as the link counts (RFC 6347,
// 4.1.2.6: a larger window may be used). It never seals, so no nonce can be used twice through it.
class RecordOpener {
 public:
  // Once the handshake of `ssl` is done. False: OpenSSL gives no key.
  bool begin(const SSL* ssl) noexcept;
  // How many bytes of `plain` the record held, which is_one_data(); 0: it is forged, repeated, too
  // late, or too long. Real-time safe.
  std::size_t open(std::span<const std::uint8_t> record, std::span<std::uint8_t> plain) noexcept;

 private:
  struct Free {
    void operator()(EVP_CIPHER_CTX* context) const noexcept;
  };
  bool is_new(std::uint64_t number) const noexcept;
  void mark(std::uint64_t number) noexcept;
  bool decrypt(std::span<const std::uint8_t> record, std::span<std::uint8_t> plain) noexcept;

  std::unique_ptr<EVP_CIPHER_CTX, Free> cipher_;
  std::array<std::uint8_t, 4> salt_{};       // the nonce's implicit part (RFC 5288)
  std::uint64_t newest_ = 0;                 // epoch and number, of those that were genuine
  std::bitset<Arrivals::kLatest + 1> seen_;  // bit i = record newest_ - i
};

}  // namespace handrail
