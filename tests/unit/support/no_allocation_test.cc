#include "tests/support/no_allocation.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace handrail::test {
namespace {

class NoAllocationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!NoAllocation::counts()) GTEST_SKIP() << "this sanitizer owns the heap";
  }
};

// Keeps the optimiser from removing a pair of new and delete.
template <typename T>
void use(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

TEST_F(NoAllocationTest, StaysQuietAboutCodeOnTheStack) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  {
    NoAllocation guard("fixed-size sum");
    for (int i = 0; i < 100; ++i) sum += Eigen::Matrix<double, 6, 1>::Constant(0.5);
    use(sum);
    EXPECT_EQ(guard.allocations(), 0u);
    EXPECT_EQ(guard.releases(), 0u);
  }
  EXPECT_DOUBLE_EQ(sum.sum(), 300.0);
}

TEST_F(NoAllocationTest, FailsTheTestWhenCodeAllocates) {
  EXPECT_NONFATAL_FAILURE(
      {
        NoAllocation guard("make_unique");
        use(std::make_unique<int>(1));
      },
      "make_unique must not touch the heap, but allocated 1 and released 1");
}

TEST_F(NoAllocationTest, FailsTheTestWhenCodeOnlyReleases) {
  auto block = std::make_unique<int>(1);
  EXPECT_NONFATAL_FAILURE(
      {
        NoAllocation guard("reset");
        block.reset();
      },
      "allocated 0 and released 1");
}

TEST_F(NoAllocationTest, CountsEveryWayToTheHeap) {
  NoAllocation guard("every way");
  const auto expect_one_more = [&guard](const char* way, void* block, auto give_back) {
    use(block);
    EXPECT_EQ(guard.allocations(), 1u) << way;
    give_back(block);
    EXPECT_EQ(guard.releases(), 1u) << way;
    guard.forget();
  };
  const auto release = [](void* block) { std::free(block); };
  guard.forget();
  expect_one_more("malloc", std::malloc(8), release);
  expect_one_more("calloc", std::calloc(2, 8), release);
  expect_one_more("realloc", std::realloc(nullptr, 8), release);
  expect_one_more("aligned_alloc", std::aligned_alloc(64, 64), release);
  void* block = nullptr;
  ASSERT_EQ(posix_memalign(&block, 64, 8), 0);
  expect_one_more("posix_memalign", block, release);
  expect_one_more("new", ::operator new(8), [](void* b) { ::operator delete(b); });
  expect_one_more("new[]", ::operator new[](8), [](void* b) { ::operator delete[](b); });
  expect_one_more("aligned new", ::operator new (64, std::align_val_t{64}),
                  [](void* b) { ::operator delete (b, std::align_val_t{64}); });
  {
    const Eigen::VectorXd v = Eigen::VectorXd::Zero(12);
    use(v);
    EXPECT_EQ(guard.allocations(), 1u) << "Eigen's dynamic vector";
  }
  guard.forget();
}

TEST_F(NoAllocationTest, CountsInsideALibrary) {
  NoAllocation guard("string in libstdc++");
  {
    std::string text;
    text.append(100, 'x');
    use(text);
    EXPECT_GE(guard.allocations(), 1u);
  }
  guard.forget();
}

TEST_F(NoAllocationTest, AnInnerGuardDoesNotHideItsAllocationsFromTheOuterOne) {
  NoAllocation outer("outer");
  {
    NoAllocation inner("inner");
    use(std::make_unique<int>(1));
    inner.forget();
  }
  EXPECT_EQ(outer.allocations(), 1u);
  outer.forget();
}

TEST_F(NoAllocationTest, IgnoresOtherThreads) {
  std::uint64_t in_thread = 0;
  std::thread other([&in_thread] {
    NoAllocation guard("other thread");
    use(std::vector<int>(1000));
    in_thread = guard.allocations();
    guard.forget();
  });
  NoAllocation guard("this thread");
  other.join();
  const std::uint64_t here = guard.allocations();
  guard.forget();  // join may give back the thread's own block
  EXPECT_EQ(here, 0u);
  EXPECT_EQ(in_thread, 1u);
}

TEST_F(NoAllocationTest, CountsTheHeapCallsOfAThrow) {
  NoAllocation guard("throw");
  try {
    throw 1;
  } catch (int) {
  }
  EXPECT_GE(guard.allocations(), 1u);
  guard.forget();
}

}  // namespace
}  // namespace handrail::test
