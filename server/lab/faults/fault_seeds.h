// Seeds as words: 7, 1..50, or both and more with commas between.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"

namespace handrail {

inline constexpr std::size_t kMostSeeds = 1000;

// What `text` names, rising, each once. An error for anything that is no number from 0 to 2^64 - 1,
// a range that falls, or more than kMostSeeds.
Result<std::vector<std::uint64_t>> parse_seeds(const std::string& text);

}  // namespace handrail
