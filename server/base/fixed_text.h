// Text that a step or another thread can copy: no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace handrail {

// Zero-terminated: holds one character less than N. Real-time safe, like all here.
template <std::size_t N>
using FixedText = std::array<char, N>;

// `text`, cut to what fits.
template <typename Text>
Text fixed_text(std::string_view text) noexcept {
  Text out{};
  std::copy_n(text.data(), std::min(text.size(), out.size() - 1), out.data());
  return out;
}

// Up to the first zero.
template <std::size_t N>
std::string_view text_of(const FixedText<N>& text) noexcept {
  return {text.data(),
          static_cast<std::size_t>(std::find(text.begin(), text.end(), '\0') - text.begin())};
}

}  // namespace handrail
