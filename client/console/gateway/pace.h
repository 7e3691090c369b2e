// How often strangers may have something done.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "server/base/time.h"

namespace handrail {

// So many in a second, and of one network so many. Holds at most as many networks as it lets pass.
class Pace {
 public:
  Pace(std::size_t of_network, std::size_t all) : of_network_(of_network), all_(all) {}

  // False: not now.
  bool take(const std::string& network, Nanos now) {
    if (now - second_ >= kSecond) {
      second_ = now;
      taken_ = 0;
      networks_.clear();
    }
    if (taken_ >= all_) return false;
    std::size_t& of_this = networks_[network];
    if (of_this >= of_network_) return false;
    ++of_this;
    ++taken_;
    return true;
  }

 private:
  const std::size_t of_network_, all_;
  Nanos second_ = -kForever;  // when this one began
  std::size_t taken_ = 0;
  std::map<std::string, std::size_t> networks_;
};

}  // namespace handrail
