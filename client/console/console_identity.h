// What a console shows that other computers reach, while the keys change.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <openssl/types.h>

#include "client/console/console_args.h"
#include "server/base/status.h"
#include "server/daemon/errand.h"
#include "server/keys/web_place.h"

namespace handrail {

// This user's key in a certificate. Empty where the console is reached from this computer alone.
struct ConsoleIdentity {
  WebPlace place;
  std::shared_ptr<SSL_CTX> tls;

  // Reads the disk.
  static Result<ConsoleIdentity> of(const ConsoleArgs& args);
};

// Looks for other keys, and another list of the trusted, without waiting for the disk.
class KeyFollower {
 public:
  struct Told {
    // The key is another one, and `keys link` knows its certificate.
    std::function<void(const ConsoleIdentity&)> shows;
    // Key or list are others: what is known of a master on another computer is to be asked anew.
    std::function<void()> changed;
    // Why they cannot be followed: what was shown before is shown on.
    std::function<void(const std::string&)> problem;
  };

  // Made before the keys are read first: what changes in between is seen.
  explicit KeyFollower(const ConsoleArgs& args);
  // `shown`: what is shown now, with the port.
  void follow(const ConsoleIdentity& shown, Told told);
  // Now and then, in the thread that is told.
  void look();

 private:
  struct Look {
    std::string stamp;
    Result<ConsoleIdentity> identity = ConsoleIdentity{};
  };

  const ConsoleArgs args_;
  std::uint16_t port_ = 0;
  Told told_;
  std::string known_;  // the folder's stamp
  std::string shown_;  // the certificate's fingerprint
  Errand<Result<Look>> errand_;
};

}  // namespace handrail
