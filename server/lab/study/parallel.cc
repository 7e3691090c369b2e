#include "server/lab/study/parallel.h"

#include <algorithm>
#include <mutex>
#include <thread>
#include <vector>

namespace handrail {

bool run_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& job,
                  const std::function<void(std::size_t)>& progress,
                  const std::atomic<bool>* cancelled) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex reporting;
  const auto work = [&]() noexcept {
    for (;;) {
      if (cancelled != nullptr && cancelled->load()) return;
      const std::size_t i = next.fetch_add(1);
      if (i >= count) return;
      job(i);
      const std::lock_guard<std::mutex> lock(reporting);
      ++done;
      if (progress) progress(done);
    }
  };
  const std::size_t wanted = threads > 0
                                 ? static_cast<std::size_t>(threads)
                                 : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 1; i < std::min(wanted, count); ++i) pool.emplace_back(work);
    work();
  }
  return done == count;
}

}  // namespace handrail
