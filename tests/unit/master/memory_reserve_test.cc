#include "server/master/memory_reserve.h"

#include <gtest/gtest.h>

#include <new>

namespace handrail {
namespace {

// `new` calls the handler when it has found no memory, and tries again when it returns.
TEST(MemoryReserve, IsHandedOutOnceUntilItIsFilledAgain) {
  {
    MemoryReserve reserve(64 * 1024);
    const std::new_handler no_memory = std::get_new_handler();
    for (int i = 0; i < 2; ++i) {
      EXPECT_FALSE(reserve.is_spent());
      no_memory();
      EXPECT_TRUE(reserve.is_spent());
      EXPECT_THROW(no_memory(), std::bad_alloc);
      EXPECT_TRUE(reserve.fill());
    }
    EXPECT_TRUE(reserve.fill());
  }
  EXPECT_EQ(std::get_new_handler(), nullptr);
}

// A sanitizer takes so large a request for an error.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(MemoryReserve, IsSpentWhileThereIsTooLittle) {
  MemoryReserve reserve(PTRDIFF_MAX);  // no machine has it
  EXPECT_TRUE(reserve.is_spent());
  EXPECT_FALSE(reserve.fill());
  EXPECT_THROW(std::get_new_handler()(), std::bad_alloc);
}
#endif

}  // namespace
}  // namespace handrail
