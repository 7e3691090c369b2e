// What others cannot guess.
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

// 32 random characters of 0 to 9 and a to f, 128 bits, fit for an address and a cookie.
Result<std::string> new_secret();

}  // namespace handrail
