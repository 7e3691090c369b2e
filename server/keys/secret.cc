#include "server/keys/secret.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace handrail {

Result<std::string> new_secret() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    return Status::error(std::string("no random numbers: ") + std::strerror(errno));
  }
  std::string out;
  for (const unsigned char byte : bytes) {
    for (const unsigned digit : {byte / 16u, byte % 16u}) out += "0123456789abcdef"[digit];
  }
  return out;
}

}  // namespace handrail
