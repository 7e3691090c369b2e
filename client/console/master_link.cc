#include "client/console/master_link.h"

#include <algorithm>
#include <utility>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

constexpr auto kStatusPeriod = static_cast<Nanos>(kSecond / PageDesk::kStatusRate);
constexpr Nanos kStatusPatience = kSecond;
constexpr Nanos kNextTry = 250 * kMillisecond;  // after a master that is not there
constexpr auto kCursorPeriod = static_cast<Nanos>(kSecond / PageDesk::kCursorRate) - kMillisecond;
constexpr Nanos kCursorAnswer = 500 * kMillisecond;
constexpr Nanos kStopAnswer = 5 * kSecond;
// An engage waits for a link and for both sides, a take for who holds the lease: 10 s.
constexpr Nanos kOrderAnswer = 15 * kSecond;
constexpr Nanos kIdle = 5 * kSecond;  // a connection that is older may be gone

// Of the thread's own worker: the client asks a function without an argument.
thread_local const std::atomic<bool>* its_cancelled = nullptr;
bool is_cancelled() { return its_cancelled != nullptr && its_cancelled->load(); }

// Whether a count has risen since it was seen last.
bool has_risen(const std::atomic<std::uint64_t>& count, std::uint64_t& seen) {
  const std::uint64_t before = seen;
  seen = count.load();
  return seen != before;
}

}  // namespace

MasterLink::MasterLink(Options options, Post post, Told tell)
    : options_(std::move(options)), post_(std::move(post)), tell_(std::move(tell)) {
  const SignalsBlocked blocked;
  start(orders_, PageDesk::kMostRequests);
  start(stops_, 1);
  status_.thread = std::thread([this] { ask_status(status_); });
  pointer_.thread = std::thread([this] { send_cursor(pointer_); });
}

MasterLink::~MasterLink() {
  ending_ = true;
  const auto end = [](Worker& worker) { worker.cancelled = true; };
  const auto join = [](Worker& worker) { worker.thread.join(); };
  const auto all = [this](const auto& f) {
    for (Queue* queue : {&orders_, &stops_}) {
      for (const auto& worker : queue->workers) f(*worker);
    }
    f(status_);
    f(pointer_);
  };
  all(end);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
  all(join);
}

void MasterLink::start(Queue& queue, std::size_t workers) {
  for (std::size_t i = 0; i < workers; ++i) queue.workers.push_back(std::make_unique<Worker>());
  for (const auto& worker : queue.workers) {
    worker->thread = std::thread([this, &queue, me = worker.get()] { carry_out(queue, *me); });
  }
}

Result<pb::Reply> MasterLink::call(OperatorClient& client, pb::Request request,
                                   Nanos patience) const {
  if (options_.observe) request.set_observer(true);
  return client.call(request, patience);
}

void MasterLink::tell_answer(std::uint64_t ticket, const Result<pb::Reply>& reply) {
  post_([this, ticket, reply] { tell_.answer(ticket, reply); });
}

void MasterLink::order(std::uint64_t ticket, const pb::Request& request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  (request.has_stop() ? stops_ : orders_).jobs.push_back({ticket, request});
  wake_.notify_all();
}

void MasterLink::withdraw(std::uint64_t ticket) {
  const std::lock_guard<std::mutex> lock(mutex_);
  auto& jobs = orders_.jobs;
  const auto waits =
      std::find_if(jobs.begin(), jobs.end(), [&](const Job& job) { return job.ticket == ticket; });
  if (waits != jobs.end()) {
    jobs.erase(waits);
    return tell_answer(ticket, Status::error("withdrawn: who asked for it has gone"));
  }
  for (const auto& worker : orders_.workers) {
    if (worker->ticket == ticket) worker->cancelled = true;
  }
}

void MasterLink::point(const pb::CursorOrder& cursor) {
  const std::lock_guard<std::mutex> lock(mutex_);
  cursor_ = cursor;
  wake_.notify_all();
}

void MasterLink::carry_out(Queue& queue, Worker& me) {
  its_cancelled = &me.cancelled;
  OperatorClient client(options_.place, options_.as, is_cancelled);
  std::uint64_t broken = 0, renewed = 0;
  Nanos used = 0;
  for (std::unique_lock<std::mutex> lock(mutex_);;) {
    wake_.wait(lock, [&] { return ending() || !queue.jobs.empty(); });
    if (ending()) return;
    const Job job = std::move(queue.jobs.front());
    queue.jobs.pop_front();
    me.ticket = job.ticket;
    me.cancelled = false;
    lock.unlock();
    const bool lost = has_risen(broken_, broken), old = has_risen(renewed_, renewed);
    if (lost || old || monotonic_now() - used > kIdle) client.close();
    const auto reply =
        call(client, job.request, job.request.has_stop() ? kStopAnswer : kOrderAnswer);
    used = monotonic_now();
    tell_answer(job.ticket, reply);
    lock.lock();
    me.ticket = 0;
  }
}

void MasterLink::ask_status(Worker& me) {
  its_cancelled = &me.cancelled;
  OperatorClient client(options_.place, options_.as, is_cancelled);
  pb::Request request;
  request.set_status(true);
  std::uint64_t renewed = 0;
  for (Nanos next = monotonic_now(); !ending();) {
    if (has_risen(renewed_, renewed)) client.close();
    const Nanos asked = monotonic_now();
    const auto reply = call(client, request, kStatusPatience);
    if (!reply) ++broken_;
    post_([this, reply, asked] { tell_.status(reply, asked); });
    // After a slow answer at most one question is made up for, so that the rate stays what it is.
    next = std::max(next + (reply ? kStatusPeriod : kNextTry), monotonic_now() - kStatusPeriod);
    sleep_until(next);
  }
}

void MasterLink::send_cursor(Worker& me) {
  its_cancelled = &me.cancelled;
  OperatorClient client(options_.place, options_.as, is_cancelled);
  std::uint64_t renewed = 0;
  for (Nanos next = 0; !ending();) {
    pb::Request request;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return ending() || cursor_; });
      if (ending()) return;
    }
    sleep_until(next);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      *request.mutable_cursor() = *std::exchange(cursor_, std::nullopt);
    }
    next = monotonic_now() + kCursorPeriod;
    if (has_risen(renewed_, renewed)) client.close();
    const auto reply = call(client, request, kCursorAnswer);
    post_([this, reply] { tell_.pointed(reply); });
  }
}

}  // namespace handrail
