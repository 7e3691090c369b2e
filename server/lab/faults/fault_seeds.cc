#include "server/lab/faults/fault_seeds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace handrail {
namespace {

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t out = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, out);
  if (error != std::errc() || last != end) return std::nullopt;
  return out;
}

}  // namespace

Result<std::vector<std::uint64_t>> parse_seeds(const std::string& text) {
  std::vector<std::uint64_t> seeds;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string_view word = std::string_view(text).substr(at, comma - at);
    at = comma + 1;
    const std::size_t dots = word.find("..");
    const auto first = number(word.substr(0, dots));
    const auto last = dots == word.npos ? first : number(word.substr(dots + 2));
    if (!first || !last) {
      return Status::error(fmt::format(
          "seeds '{}': '{}' is no seed and no range; expected such as 7 or 1..50", text, word));
    }
    if (*first > *last) {
      return Status::error(fmt::format("seeds '{}': {} is after {}; expected a range that rises",
                                       text, *first, *last));
    }
    if (*last - *first >= kMostSeeds - seeds.size()) {
      return Status::error(
          fmt::format("seeds '{}': too many; expected at most {}", text, kMostSeeds));
    }
    for (std::uint64_t i = 0; i <= *last - *first; ++i) seeds.push_back(*first + i);
  }
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  return seeds;
}

}  // namespace handrail
