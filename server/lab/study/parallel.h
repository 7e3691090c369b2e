// Independent jobs on all cores.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace handrail {

// Calls job(i) once for every i below `count`, on `threads` threads (0: one a core). What a job
// writes must belong to its i alone; then results do not depend on the number of threads. A raised
// `cancelled` lets running jobs end and starts no more. `progress`, if any, is called from one
// thread at a time after each job with the number done. True when every job ran. An exception of a
// job ends the program.
bool run_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& job,
                  const std::function<void(std::size_t)>& progress = {},
                  const std::atomic<bool>* cancelled = nullptr);

}  // namespace handrail
