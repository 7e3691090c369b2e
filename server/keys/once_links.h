// Addresses for browsers on other computers that are good once, and for a short time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/status.h"
#include "server/keys/roles.h"

namespace handrail {

// Times: seconds since 1970.
struct OnceLink {
  std::string id;               // to name it by; no secret
  Role role = Role::kObserver;  // operator or observer
  std::int64_t made = 0, until = 0;
  std::int64_t used = 0;  // 0: not yet
  std::string hash;       // SHA-256 of its token, 64 digits
};

// In the folder of the keys the file `links`, mode 0600: "ID ROLE MADE UNTIL USED HASH" a line. The
// token itself is nowhere: who reads the file cannot use a link. Reads and writes the disk, and
// waits for other programs of this user that do.
class OnceLinks {
 public:
  static constexpr std::size_t kMost = 64;
  // A session lasts so long; a link that is used is known for as long, one that is over too.
  static constexpr std::int64_t kSessionLife = 12 * 3600;  // [s]: a working day

  explicit OnceLinks(std::string folder) : folder_(std::move(folder)) {}

  struct Made {
    OnceLink link;
    std::string token;  // 128 bits
  };
  // `life`: seconds. The error says what is wrong with the folder, or that there are too many.
  Result<Made> make(Role role, std::int64_t life, std::int64_t now) const;

  enum class Found : std::uint8_t { kGood, kUsed, kExpired, kUnknown };
  struct Taken {
    Found found = Found::kUnknown;
    OnceLink link;  // kGood
  };
  // kGood once: whoever asks at the same time, in this program or another, finds it used.
  Result<Taken> take(std::string_view token, std::int64_t now) const;

  // Without those that are long over, the oldest first.
  Result<std::vector<OnceLink>> list(std::int64_t now) const;
  // Returns what was done. A session of it ends within a second.
  Result<std::string> remove(const std::string& id, std::int64_t now) const;
  // Another one when the file has changed, without reading it.
  std::string stamp() const;
  std::string path() const { return folder_ + "/links"; }

 private:
  Status save(const std::vector<OnceLink>& links) const;

  std::string folder_;
};

// As the file has them. `place` stands before an error. At most kMost lines count.
Result<std::vector<OnceLink>> parse_once_links(std::string_view text, const std::string& place);
std::string once_links_text(const std::vector<OnceLink>& links);

}  // namespace handrail
