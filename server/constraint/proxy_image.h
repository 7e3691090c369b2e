// Values one after another in an image, and back. For those who keep a WallProxy's memory.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>

namespace handrail {

// Returns the bytes taken; `out` must hold them. Values without addresses only. Real-time safe.
template <typename... Values>
std::size_t put_in_image(std::span<std::byte> out, const Values&... values) noexcept {
  std::size_t at = 0;
  ((std::memcpy(out.data() + at, static_cast<const void*>(&values), sizeof(values)),
    at += sizeof(values)),
   ...);
  return at;
}

// False, and nothing is changed, where the image is not as long as these. Real-time safe.
template <typename... Values>
bool take_from_image(std::span<const std::byte> image, Values&... values) noexcept {
  if (image.size() != (sizeof(values) + ... + 0)) return false;
  std::size_t at = 0;
  ((std::memcpy(static_cast<void*>(&values), image.data() + at, sizeof(values)),
    at += sizeof(values)),
   ...);
  return true;
}

}  // namespace handrail
