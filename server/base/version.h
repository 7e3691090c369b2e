// Which Handrail a program is.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "handrail_version.h"

namespace handrail {

// "0.1.0", of the build.
inline const char* program_version() noexcept { return HANDRAIL_VERSION; }

// Prints "handrail-lab 0.1.0" where a program is asked for its version and nothing else.
inline bool says_version(const char* program, int argc, const char* const* argv) {
  if (argc != 2 || std::strcmp(argv[1], "--version") != 0) return false;
  std::printf("%s %s\n", program, program_version());
  return true;
}

inline constexpr unsigned kLargestVersionPart = 1023;  // ten bits

// The same as a number, ten bits for each of its three parts, the last lowest. 0: no version.
inline std::uint32_t version_code(const std::string& version) noexcept {
  unsigned major = 0, minor = 0, patch = 0;
  if (std::sscanf(version.c_str(), "%u.%u.%u", &major, &minor, &patch) != 3) return 0;
  for (const unsigned part : {major, minor, patch}) {
    if (part > kLargestVersionPart) return 0;
  }
  return major << 20 | minor << 10 | patch;
}

// The other way; "unknown" of 0.
inline std::string version_text(std::uint32_t code) {
  if (code == 0) return "unknown";
  return std::to_string(code >> 20) + "." + std::to_string(code >> 10 & kLargestVersionPart) + "." +
         std::to_string(code & kLargestVersionPart);
}

}  // namespace handrail
