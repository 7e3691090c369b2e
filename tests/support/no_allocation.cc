#include "tests/support/no_allocation.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <utility>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HANDRAIL_SANITIZER_OWNS_HEAP 1
#endif

namespace {

struct HeapCalls {
  std::uint64_t allocations = 0;
  std::uint64_t releases = 0;
};

// Static storage and constant initialisation: reading it never allocates, not even in a new thread.
thread_local constinit HeapCalls calls;

}  // namespace

#ifndef HANDRAIL_SANITIZER_OWNS_HEAP

// Names under which glibc keeps its own functions reachable for a program that replaces malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

// libstdc++'s operator new and delete end here as well.
void* malloc(std::size_t size) noexcept {
  ++calls.allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++calls.allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  ++calls.allocations;
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++calls.allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++calls.allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0) return EINVAL;
  ++calls.allocations;
  void* const result = __libc_memalign(alignment, size);
  if (result == nullptr) return ENOMEM;
  *block = result;
  return 0;
}
void free(void* block) noexcept {
  if (block != nullptr) ++calls.releases;
  __libc_free(block);
}
}  // extern "C"

#endif

namespace handrail::test {

NoAllocation::NoAllocation(std::string what) : what_(std::move(what)) {
  [[maybe_unused]] static const bool said = [] {
    if (!counts()) std::puts("note: heap calls are not counted under this sanitizer");
    return true;
  }();
  allocations_before_ = calls.allocations;
  releases_before_ = calls.releases;
}

NoAllocation::~NoAllocation() {
  const std::uint64_t taken = allocations(), given_back = releases();
  if (taken == 0 && given_back == 0) return;
  ADD_FAILURE() << what_ << " must not touch the heap, but allocated " << taken << " and released "
                << given_back << " block(s)";
}

std::uint64_t NoAllocation::allocations() const noexcept {
  return calls.allocations - allocations_before_;
}

std::uint64_t NoAllocation::releases() const noexcept { return calls.releases - releases_before_; }

void NoAllocation::forget() noexcept {
  allocations_before_ = calls.allocations;
  releases_before_ = calls.releases;
}

bool NoAllocation::counts() noexcept {
#ifdef HANDRAIL_SANITIZER_OWNS_HEAP
  return false;
#else
  return true;
#endif
}

}  // namespace handrail::test
