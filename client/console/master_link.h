// The gateway's conversations with the master, each in a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/api/operator_client.h"
#include "client/console/gateway/page_desk.h"

namespace handrail {

// The master answers one request after the other on a connection, some after seconds: so the status
// has one, the cursor one, stops one, and other orders as many as a page may have under way. A
// connection that breaks is opened again with the next request. What comes is told by `tell`, in
// whose thread `post` runs it.
class MasterLink final : public MasterOrders {
 public:
  struct Options {
    MasterPlace place;
    std::string as;  // who speaks; empty: as the master knows us
    bool observe = false;
  };
  // In the thread that `post` has.
  struct Told {
    std::function<void(const Result<pb::Reply>&, Nanos asked)> status;
    std::function<void(std::uint64_t ticket, const Result<pb::Reply>&)> answer;
    std::function<void(const Result<pb::Reply>&)> pointed;
  };
  using Post = std::function<void(std::function<void()>)>;

  MasterLink(Options options, Post post, Told tell);
  ~MasterLink() override;

  void order(std::uint64_t ticket, const pb::Request& request) override;
  void withdraw(std::uint64_t ticket) override;
  void point(const pb::CursorOrder& cursor) override;
  // Other keys count: every connection is made anew, once it has answered what is under way.
  void renew() { ++renewed_; }

 private:
  struct Job {
    std::uint64_t ticket;
    pb::Request request;
  };
  // One that carries out jobs of a queue.
  struct Worker {
    std::atomic<bool> cancelled{false};
    std::uint64_t ticket = 0;  // under way; 0: none
    std::thread thread;
  };
  struct Queue {
    std::deque<Job> jobs;
    std::vector<std::unique_ptr<Worker>> workers;
  };

  void start(Queue& queue, std::size_t workers);
  void carry_out(Queue& queue, Worker& me);
  void ask_status(Worker& me);
  void send_cursor(Worker& me);
  Result<pb::Reply> call(OperatorClient& client, pb::Request request, Nanos patience) const;
  void tell_answer(std::uint64_t ticket, const Result<pb::Reply>& reply);
  bool ending() const { return ending_.load(std::memory_order_relaxed); }

  const Options options_;
  const Post post_;
  const Told tell_;
  std::mutex mutex_;  // of all below but the atomics
  std::condition_variable wake_;
  Queue orders_, stops_;
  std::optional<pb::CursorOrder> cursor_;
  std::atomic<std::uint64_t> broken_{0};   // times the master was lost
  std::atomic<std::uint64_t> renewed_{0};  // times the keys have changed
  std::atomic<bool> ending_{false};
  Worker status_, pointer_;
};

}  // namespace handrail
