// Proof that a piece of code does not allocate.
#pragma once

#include <cstdint>
#include <string>

namespace handrail::test {

// While it lives, heap calls of the calling thread are counted: operator new and delete in every
// form, malloc, calloc, realloc, aligned_alloc, posix_memalign and free, wherever they come from.
// The destructor adds one test failure, with `what` and the counts, when there were any. Guards
// nest; other threads are not seen.
//
//   { NoAllocation guard("follow_step"); follow_step(...); }
//
// Under AddressSanitizer or ThreadSanitizer, which own the heap, nothing is counted: `counts()` is
// false and the guard says so once on the standard output.
class NoAllocation {
 public:
  explicit NoAllocation(std::string what);
  ~NoAllocation();
  NoAllocation(const NoAllocation&) = delete;
  NoAllocation& operator=(const NoAllocation&) = delete;

  // Blocks taken, and given back, since construction.
  std::uint64_t allocations() const noexcept;
  std::uint64_t releases() const noexcept;
  // Accepts what happened so far: the destructor reports only what comes later.
  void forget() noexcept;

  // Whether this build counts at all.
  static bool counts() noexcept;

 private:
  std::string what_;
  std::uint64_t allocations_before_;
  std::uint64_t releases_before_;
};

}  // namespace handrail::test
