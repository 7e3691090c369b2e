// Times several functions in turn, so that their figures compare whatever else the machine does.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

namespace handrail {

class Contest {
 public:
  // Time of one call, from batches [ns].
  struct Time {
    double median = 0.0;
    double p999 = 0.0;
  };

  // `batch` makes `calls` calls; `prepare`, untimed, goes before each of its turns.
  void add(std::function<void()> prepare, std::function<void()> batch, int calls);
  // Goes round all entrants `turns` times, `batches` of each a turn, the first turn untimed; who
  // begins changes from turn to turn. Ends early once `cancelled` is raised.
  void run(int turns, int batches, const std::atomic<bool>& cancelled);

  // Of all batches of entrant `i`, without the clock's own cost, never below 0.
  Time time(std::size_t i) const;
  // How much longer a call of `i` takes than one of `k`: the median over turns of the difference of
  // their medians within the turn, so that what is slow for both falls out [ns].
  double longer(std::size_t i, std::size_t k) const;

 private:
  struct Entrant {
    std::function<void()> prepare, batch;
    int calls = 1;
    std::vector<float> samples;  // of one call [ns]
    std::vector<double> turns;   // median of each [ns]
  };
  std::vector<Entrant> entrants_;
};

// Keeps the compiler from leaving out what `value` takes to compute.
template <typename T>
inline void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace handrail
