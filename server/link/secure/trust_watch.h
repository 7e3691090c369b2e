// Whether the list of the trusted has changed on the disk, without waiting for the disk.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "server/base/time.h"
#include "server/daemon/errand.h"
#include "server/keys/key_folder.h"

namespace handrail {

class TrustWatch {
 public:
  // Who removes a key waits so long for the end of its session.
  static constexpr Nanos kLook = 500 * kMillisecond;

  // `known`: the folder's stamp when the list was read last.
  TrustWatch(KeyFolder folder, std::string known)
      : folder_(std::move(folder)), known_(std::move(known)) {}

  // The list, or why it cannot be read, once for each change. Never waits.
  std::optional<Result<TrustList>> poll(Nanos now) {
    if (now < next_) return std::nullopt;
    const auto looked = errand_.poll([folder = folder_, known = known_]() -> Result<Look> {
      // The stamp first: a change between the two is seen next time.
      const std::string stamp = folder.stamp();
      if (stamp == known) return Look{stamp, std::nullopt};
      return Look{stamp, folder.trusted()};
    });
    if (!looked) return std::nullopt;
    next_ = now + kLook;
    if (!*looked) return Result<TrustList>(looked->status());
    known_ = (*looked)->stamp;
    return (*looked)->list;
  }

 private:
  struct Look {
    std::string stamp;
    std::optional<Result<TrustList>> list;
  };

  KeyFolder folder_;
  std::string known_;
  Nanos next_ = -kForever;
  Errand<Result<Look>> errand_;
};

}  // namespace handrail
