// Random numbers that are the same for the same input, so that a finding can be seen again. They
// are OpenSSL's, of every target in the program.
#pragma once

#include <openssl/rand.h>

#include <cstdint>

namespace handrail::fuzz {

// OpenSSL has them from here on: call at the begin of an input.
inline void fix_random() {
  static std::uint64_t state;
  state = 1;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  static const RAND_METHOD method = [] {
    const auto fill = [](unsigned char* out, int size) {
      for (int i = 0; i < size; ++i) {
        state = state * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX
        out[i] = static_cast<unsigned char>(state >> 56);
      }
      return 1;
    };
    return RAND_METHOD{nullptr, fill, nullptr, nullptr, fill, [] { return 1; }};
  }();
  static const bool set = RAND_set_rand_method(&method) == 1;
#pragma GCC diagnostic pop
  (void)set;
}

}  // namespace handrail::fuzz
