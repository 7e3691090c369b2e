// A real operator server on a socket of its own, with a scripted master behind it.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/base/length_prefix.h"
#include "server/master/operator_server.h"
#include "tests/support/temp_folder.h"

namespace handrail {

// Status: done, ticks count the requests. Engage: keeps the reply for later. Reset: refused. Stop:
// drops the reply. Anything else: done, with the order's name as the reason.
class ScriptedMaster : public OperatorHandler {
 public:
  void handle(const pb::Request& request, std::function<void(pb::Reply)> reply) override {
    const int n = ++requests;
    pb::Reply answer;
    answer.set_done(true);
    if (request.has_status()) {
      answer.mutable_status()->set_ticks(static_cast<std::uint64_t>(n));
      answer.mutable_status()->set_state("off");
      if (on_status) on_status(n);
    } else if (request.has_engage()) {
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
  // Replies kept so far, which leave this object.
  std::vector<std::function<void(pb::Reply)>> take_kept() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::move(kept_);
  }

  std::atomic<int> requests{0};
  std::function<void(int)> on_status;  // set before serving

 private:
  std::mutex mutex_;
  std::vector<std::function<void(pb::Reply)>> kept_;
};

class OperatorBench {
 public:
  explicit OperatorBench(const std::string& path,
                         std::size_t max_clients = OperatorServer::kMaxClients)
      : path_(path), server_(io_, master, max_clients) {
    status_ = server_.start(path);
    thread_ = std::thread([this] { io_.run(); });
  }
  ~OperatorBench() {
    run([this] { server_.stop(); });
    master.take_kept();
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

  ScriptedMaster master;

 private:
  std::string path_;
  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_ =
      boost::asio::make_work_guard(io_);
  OperatorServer server_;
  Status status_ = Status::ok();
  std::thread thread_;
};

// A connection that says what no proper client would.
class RawClient {
 public:
  explicit RawClient(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address.sun_path);
    fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    connected_ = ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~RawClient() { ::close(fd_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return connected_; }
  bool send(const std::string& bytes) {
    return ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  // One reply; done false with reason "(closed)" at the end of the connection.
  pb::Reply receive() {
    pb::Reply reply;
    std::string header(kFrameHeader, '\0');
    std::string body;
    if (read_exactly(header)) {
      body.resize(frame_size(header.data()));
      if (read_exactly(body) && reply.ParseFromString(body)) return reply;
    }
    reply.set_done(false);
    reply.set_reason("(closed)");
    return reply;
  }

 private:
  bool read_exactly(std::string& out) {
    for (std::size_t done = 0; done < out.size();) {
      const ssize_t n = ::recv(fd_, out.data() + done, out.size() - done, 0);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }
  int fd_ = -1;
  bool connected_ = false;
};

inline std::string status_frame() {
  pb::Request request;
  request.set_status(true);
  return framed(request.SerializeAsString());
}

}  // namespace handrail
