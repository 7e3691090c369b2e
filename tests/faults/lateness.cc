#include "tests/faults/lateness.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/daemon/io_thread.h"

namespace handrail::faults {
namespace {

constexpr Nanos kOnTime = 100 * kMicrosecond;  // what a free processor takes to wake somebody

}  // namespace

LatenessLog::LatenessLog(std::vector<Late> all) : all_(std::move(all)) {
  std::sort(all_.begin(), all_.end(), [](const Late& a, const Late& b) { return a.due < b.due; });
  for (const Late& one : all_) longest_ = std::max(longest_, one.late);
}

Nanos LatenessLog::worst(Nanos from, Nanos to) const {
  Nanos out = 0;
  const auto begin = std::lower_bound(all_.begin(), all_.end(), from - longest_,
                                      [](const Late& a, Nanos at) { return a.due < at; });
  for (auto i = begin; i != all_.end() && i->due <= to; ++i) {
    if (i->due + i->late >= from) out = std::max(out, i->late);
  }
  return out;
}

Nanos LatenessLog::worst() const { return longest_; }

LatenessProbe::LatenessProbe(bool real_time) : real_time_(real_time) {
  const unsigned processors = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < processors; ++i) {
    threads_.push_back(std::make_unique<Thread>());
    Thread& made = *threads_.back();
    made.thread = std::thread([this, &made, i] { run(made, i); });
  }
}

LatenessProbe::~LatenessProbe() {
  ended_ = true;
  for (const auto& one : threads_) {
    if (one->thread.joinable()) one->thread.join();
  }
}

void LatenessProbe::run(Thread& thread, unsigned processor) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(processor, &only);
  (void)::pthread_setaffinity_np(::pthread_self(), sizeof only, &only);
  const sched_param priority{.sched_priority = kIoPriority};
  if (real_time_) (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority);
  Nanos due = monotonic_now();
  while (!ended_) {
    sleep_until(due += kMillisecond);
    const Nanos late = monotonic_now() - due;
    if (late > kOnTime) thread.found.push_back({due, late});
    if (late > kMillisecond) due += late - late % kMillisecond;
  }
}

LatenessLog LatenessProbe::finish() {
  ended_ = true;
  std::vector<Late> all;
  for (const auto& one : threads_) {
    one->thread.join();
    all.insert(all.end(), one->found.begin(), one->found.end());
  }
  return LatenessLog(std::move(all));
}

}  // namespace handrail::faults
