// What the fuzz targets share: their entry, how they take an input apart, and how they say that
// something does not hold.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace handrail::fuzz {

using Bytes = std::span<const std::uint8_t>;

// Ends the program where it does not hold: libFuzzer keeps the input, a replay fails.
inline void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

inline std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// An input, taken apart from its front. What is missing at its end reads as zero.
class Input {
 public:
  explicit Input(Bytes bytes) : left_(bytes) {}

  bool empty() const { return left_.empty(); }
  std::size_t left() const { return left_.size(); }
  template <typename T>
  T take() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    const Bytes part = take_bytes(sizeof(T));
    if (!part.empty()) std::memcpy(&value, part.data(), part.size());
    return value;
  }
  // As many, or all that are left.
  Bytes take_bytes(std::size_t count) {
    const Bytes part = left_.first(std::min(count, left_.size()));
    left_ = left_.subspan(part.size());
    return part;
  }

 private:
  Bytes left_;
};

// How many acts of a session an input of so many bytes may have. Short ones reach nearly all, and
// three of them take as long as a long one, which one input in eight may be.
inline std::size_t most_acts(std::size_t input_bytes) { return input_bytes % 8 == 0 ? 150 : 40; }

struct Target {
  const char* name;
  void (*run)(Bytes);
};
// Those that are linked.
inline std::vector<Target>& targets() {
  static std::vector<Target> all;
  return all;
}

}  // namespace handrail::fuzz

// Begins the body of target NAME, whose input is `bytes`. A fuzzer is one target behind libFuzzer's
// entry; the replay of the corpora has all of them.
#ifdef HANDRAIL_FUZZER
#define HANDRAIL_FUZZ_ENTRY(NAME)                                                     \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    run_##NAME({data, size});                                                         \
    return 0;                                                                         \
  }
#else
#define HANDRAIL_FUZZ_ENTRY(NAME)   \
  static const bool listed_##NAME = \
      (handrail::fuzz::targets().push_back({#NAME, run_##NAME}), true);
#endif
#define HANDRAIL_FUZZ(NAME)                            \
  static void run_##NAME(handrail::fuzz::Bytes bytes); \
  HANDRAIL_FUZZ_ENTRY(NAME)                            \
  static void run_##NAME(handrail::fuzz::Bytes bytes)
