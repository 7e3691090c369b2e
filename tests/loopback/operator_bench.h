// A real operator server on a socket of its own, with what a test puts in the master's place.
#pragma once

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/master/operator_server.h"
#include "tests/loopback/raw_client.h"
#include "tests/support/temp_folder.h"

namespace handrail {

// Status: done, ticks count the requests. Engage: keeps the reply for later. Reset: refused. Stop:
// drops the reply, or keeps it, too. Anything else: done, with the order's name as the reason.
class ScriptedMaster : public OperatorHandler {
 public:
  void handle(const pb::Request& request, std::function<void(pb::Reply)> reply,
              StillWaits /*waits*/) override {
    const int n = ++requests;
    pb::Reply answer;
    answer.set_done(true);
    if (request.has_status()) {
      answer.mutable_status()->set_ticks(static_cast<std::uint64_t>(n));
      answer.mutable_status()->set_state("off");
      if (why) answer.mutable_status()->mutable_ledger()->set_sentence(why(n));
      if (on_status) on_status(n);
    } else if (request.has_engage() || (request.has_stop() && keeps_stops)) {
      const std::lock_guard<std::mutex> lock(mutex_);
      kept_.push_back(std::move(reply));
      return;
    } else if (request.has_stop()) {
      return;
    } else if (request.has_reset()) {
      answer.set_done(false);
      answer.set_reason("nothing to reset");
    } else {
      answer.set_reason(request.ShortDebugString());
    }
    reply(answer);
    reply(answer);  // only the first call counts
  }
  bool may_drive(const std::optional<std::string>& as) const override {
    return holder.empty() || as.value_or("") == holder;
  }
  // Replies kept so far, which leave this object.
  std::vector<std::function<void(pb::Reply)>> take_kept() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::move(kept_);
  }

  std::atomic<int> requests{0};
  std::function<void(int)> on_status;   // set before serving
  std::function<std::string(int)> why;  // of the n-th status; set before serving
  std::string holder;                   // of the lease; set in the IO thread
  std::atomic<bool> keeps_stops{false};

 private:
  std::mutex mutex_;
  std::vector<std::function<void(pb::Reply)>> kept_;
};

// `Handler`: what stands for the master.
template <typename Handler>
class BenchOf {
 public:
  explicit BenchOf(const std::string& path, std::size_t max_clients = OperatorServer::kMaxClients)
      : path_(path), server_(io_, master, max_clients) {
    status_ = server_.start(path);
    thread_ = std::thread([this] { io_.run(); });
  }
  ~BenchOf() {
    run([this] { server_.stop(); });
    work_.reset();
    thread_.join();
  }
  // Runs `f` in the IO thread and waits for it.
  template <typename F>
  void run(F f) {
    std::promise<void> done;
    boost::asio::post(io_, [&] {
      f();
      done.set_value();
    });
    done.get_future().wait();
  }
  std::size_t clients() {
    std::size_t n = 0;
    run([&] { n = server_.clients(); });
    return n;
  }
  const Status& status() const { return status_; }
  const std::string& path() const { return path_; }

  Handler master;

 private:
  std::string path_;
  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_ =
      boost::asio::make_work_guard(io_);
  OperatorServer server_;
  Status status_ = Status::ok();
  std::thread thread_;
};

using OperatorBench = BenchOf<ScriptedMaster>;

}  // namespace handrail
