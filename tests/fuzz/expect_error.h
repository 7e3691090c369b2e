// What every error about a text or a file must be.
#pragma once

#include <string>

#include "server/base/plain_text.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail::fuzz {

// One line of plain text that begins with the place, and no essay.
inline void require_error_at(const std::string& place, const std::string& message) {
  constexpr std::size_t kLongest = 4096;
  require(message.starts_with(place), "an error says where");
  require(message.size() > place.size() + 4, "an error says what");
  require(message.size() < place.size() + kLongest, "an error is no essay");
  require(message.find('\n') == std::string::npos, "an error is one line");
  require(is_plain_text(message), "an error is plain text: " + message);
}

}  // namespace handrail::fuzz
