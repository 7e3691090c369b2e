#include "server/master/operator_server.h"

#include <poll.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <new>
#include <string_view>
#include <utility>

#include "server/base/clock.h"
#include "server/base/length_prefix.h"

namespace handrail {

namespace asio = boost::asio;
using Error = boost::system::error_code;
using Socket = asio::local::stream_protocol::socket;
using Acceptor = asio::local::stream_protocol::acceptor;

namespace {

// Let in at once, before those who are in are heard again: each takes some 40 us among a thousand,
// so all of them less than a millisecond.
constexpr int kMostAdmitted = 16;
constexpr auto kAcceptPause = std::chrono::milliseconds(1);

pb::Reply refusal(const std::string& reason) {
  pb::Reply reply;
  reply.set_done(false);
  reply.set_reason(reason);
  return reply;
}

}  // namespace

// One connection: gather a frame, have it handled, answer, again.
class OperatorServer::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Socket socket, OperatorServer& server, std::optional<Trusted> speaker)
      : socket_(std::move(socket)),
        timer_(socket_.get_executor()),
        server_(server),
        speaker_(std::move(speaker)) {}

  // Who has just come has mostly said already what he wants.
  void begin() {
    heard_ = monotonic_now();
    socket_.non_blocking(true);
    read();
  }
  // Answers and, with `last`, closes afterwards.
  void answer(const pb::Reply& reply, bool last) {
    stop_waits_ = false;
    out_ = framed(reply.SerializeAsString());
    limit_time();
    asio::async_write(socket_, asio::buffer(out_),
                      [self = shared_from_this(), last](Error error, std::size_t) {
                        self->timer_.cancel();
                        if (error || last) return self->close();
                        self->heard_ = monotonic_now();
                        self->in_memory([&] { self->take_request(); });
                      });
  }
  void close() {
    Error ignored;
    timer_.cancel();
    socket_.close(ignored);
    in_.clear();
  }
  // Says why and closes, whether anybody reads it or not, or memory is left to say it.
  void dismiss(std::string_view why) {
    try {
      Error ignored;
      socket_.send(asio::buffer(framed(refusal(std::string(why)).SerializeAsString())),
                   MSG_NOSIGNAL, ignored);
    } catch (const std::bad_alloc&) {
    }
    close();
  }
  bool is_open() const { return socket_.is_open(); }
  // Its program has ended, or closed the connection. One that only says no more still listens.
  bool has_hung_up() {
    ::pollfd peer{socket_.native_handle(), 0, 0};
    return ::poll(&peer, 1, 0) > 0 && (peer.revents & POLLHUP) != 0;
  }
  bool stops() const { return request_.has_stop(); }
  // In whose place another may come: the lowest first.
  int rank() const {
    if (stop_waits_) return 2;
    return drives() ? 1 : 0;
  }
  // Has given an order, and speaks for who may.
  bool drives() const { return gives_orders_ && server_.handler_.may_drive(as_); }
  Nanos heard() const { return heard_; }  // newest whole frame, or when it came
  std::size_t bytes_held() const { return in_.size(); }
  // Hands its request to the handler, which answers when it has the answer.
  void have_handled();
  // Whoever cannot be served for want of memory is cut off, and does not wait in vain.
  template <typename F>
  void in_memory(const F& f) {
    try {
      f();
    } catch (const std::bad_alloc&) {
      close();
    }
    server_.regain_memory();
  }

 private:
  class Ticket;

  void limit_time() {
    timer_.expires_after(std::chrono::nanoseconds(kPatience));
    timer_.async_wait([weak = weak_from_this()](Error error) {
      const auto self = weak.lock();
      if (!error && self) self->close();
    });
  }
  void await_bytes() {
    socket_.async_wait(Socket::wait_read, [self = shared_from_this()](Error error) {
      if (!error) self->in_memory([&] { self->read(); });
    });
  }
  void read() {
    std::array<char, 4096> part;
    Error error;
    const std::size_t count = socket_.read_some(asio::buffer(part), error);
    if (error == asio::error::would_block) return await_bytes();
    if (error) return close();
    in_.append({part.data(), count});
    take_request();
  }
  // The first request of what has come, if it is whole.
  void take_request() {
    if (!is_open()) return;
    std::optional<Result<pb::Request>> request = in_.next();
    if (!request) {
      if (in_.size() != 0 && !std::exchange(rest_is_timed_, true)) limit_time();
      return await_bytes();
    }
    rest_is_timed_ = false;
    timer_.cancel();
    heard_ = monotonic_now();
    if (!request->is_ok()) return answer(refusal(request->message()), true);
    request_ = std::move(**request);
    const std::string problem = claim_request(speaker_ ? &*speaker_ : nullptr, request_);
    if (!problem.empty()) return answer(refusal(problem), false);
    if (is_order(request_)) {
      gives_orders_ = true;
      as_ = request_.has_as() ? std::optional(request_.as()) : std::nullopt;
    }
    server_.take(shared_from_this());
  }

  Socket socket_;
  asio::steady_timer timer_;
  OperatorServer& server_;
  const std::optional<Trusted> speaker_;  // proven; none: of this computer
  Nanos heard_ = 0;
  bool gives_orders_ = false;      // has done, at least once
  std::optional<std::string> as_;  // in whose name, in the newest
  bool stop_waits_ = false;        // for its answer
  RequestStream in_;               // what has come and was not taken: a frame and 4 KiB at most
  bool rest_is_timed_ = false;
  pb::Request request_;
  std::string out_;
};

// What a handler holds of a client: the right to answer once. It does not keep the client alive, so
// a handler may outlive server and io_context.
class OperatorServer::Client::Ticket {
 public:
  explicit Ticket(std::weak_ptr<Client> client) : client_(std::move(client)) {}
  ~Ticket() {
    try {
      in_io_thread([](Client& client) { client.close(); });
    } catch (const std::bad_alloc&) {
      // Its client waits for as long as it has patience.
    }
  }
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;

  void answer(pb::Reply reply) {
    in_io_thread([reply = std::move(reply)](Client& client) {
      if (client.is_open()) client.answer(reply, false);
    });
  }

 private:
  // The first call only.
  template <typename F>
  void in_io_thread(F f) {
    if (used_.exchange(true)) return;
    const auto client = client_.lock();
    if (!client) return;
    asio::post(client->socket_.get_executor(),
               [client, f = std::move(f)] { client->in_memory([&] { f(*client); }); });
  }
  std::weak_ptr<Client> client_;
  std::atomic<bool> used_{false};
};

void OperatorServer::Client::have_handled() {
  stop_waits_ = stops();
  const auto ticket = std::make_shared<Ticket>(weak_from_this());
  const pb::Request request = std::exchange(request_, pb::Request());
  server_.handler_.handle(
      request, [ticket](pb::Reply reply) { ticket->answer(std::move(reply)); },
      [weak = weak_from_this()] {
        const auto client = weak.lock();
        return client && client->is_open() && !client->has_hung_up();
      });
}

OperatorServer::OperatorServer(asio::io_context& io, OperatorHandler& handler,
                               std::size_t max_clients)
    : handler_(handler), max_clients_(max_clients), acceptor_(io), pause_(io), next_turns_(io) {}

OperatorServer::~OperatorServer() { stop(); }

Status OperatorServer::start(const std::string& path) {
  if (Status status = file_.claim(path); !status) return status;
  acceptor_.assign(asio::local::stream_protocol(), file_.release());
  acceptor_.non_blocking(true);
  running_ = std::make_shared<int>();
  accept();
  return Status::ok();
}

void OperatorServer::stop() {
  Error ignored;
  running_.reset();
  pause_.cancel();
  next_turns_.cancel();
  acceptor_.close(ignored);
  for (const auto& client : clients_) client->close();
  clients_.clear();
  file_.remove();
}

std::size_t OperatorServer::clients() const {
  return static_cast<std::size_t>(std::count_if(
      clients_.begin(), clients_.end(), [](const auto& client) { return client->is_open(); }));
}

void OperatorServer::accept() {
  acceptor_.async_wait(Acceptor::wait_read, [this, running = std::weak_ptr(running_)](Error error) {
    if (running.expired()) return;
    Admitted last = error ? Admitted::kNoMeans : Admitted::kOne;
    std::erase_if(clients_, [](const auto& client) { return !client->is_open(); });
    try {
      for (int i = 0; i < kMostAdmitted && last == Admitted::kOne; ++i) last = admit_one();
    } catch (const std::bad_alloc&) {
      last = Admitted::kNoMeans;
    }
    if (last != Admitted::kNoMeans) return accept();
    // No descriptor or memory for who waits: asking again at once would only spin.
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([this, running](Error) {
      if (!running.expired()) accept();
    });
  });
}

OperatorServer::Admitted OperatorServer::admit_one() {
  Error error;
  Socket socket = acceptor_.accept(error);
  if (error == Error(asio::error::no_descriptors) && !clients_.empty()) {
    dismiss_one();
    socket = acceptor_.accept(error);
  }
  if (error == asio::error::would_block) return Admitted::kNobodyWaits;
  if (error) return Admitted::kNoMeans;
  take_in(std::make_shared<Client>(std::move(socket), *this, std::nullopt));
  return Admitted::kOne;
}

void OperatorServer::admit(Socket socket, Trusted speaker) {
  std::erase_if(clients_, [](const auto& client) { return !client->is_open(); });
  take_in(std::make_shared<Client>(std::move(socket), *this, std::move(speaker)));
}

void OperatorServer::take_in(std::shared_ptr<Client> client) {
  if (clients_.size() >= max_clients_) dismiss_one();
  clients_.push_back(client);
  client->in_memory([&] { client->begin(); });
}

void OperatorServer::dismiss_one() {
  const auto needed_less = [](const auto& a, const auto& b) {
    return std::pair(a->rank(), a->heard()) < std::pair(b->rank(), b->heard());
  };
  const auto least = std::min_element(clients_.begin(), clients_.end(), needed_less);
  if (!std::exchange(said_full_, true)) {
    spdlog::warn("operators: no room for more than {} clients; who is needed least makes room",
                 clients_.size());
  }
  (*least)->dismiss("another client took your place: there is room for " +
                    std::to_string(clients_.size()));
  clients_.erase(least);
}

void OperatorServer::regain_memory() {
  if (!reserve_.is_spent()) return;
  if (!std::exchange(said_short_, true)) {
    spdlog::warn("operators: memory is short; who holds most of it and does not drive makes room");
  }
  while (!reserve_.fill()) {
    const auto needed_less = [](const auto& a, const auto& b) {
      return std::pair(a->rank(), b->bytes_held()) < std::pair(b->rank(), a->bytes_held());
    };
    const auto least = std::min_element(clients_.begin(), clients_.end(), needed_less);
    if (least == clients_.end() || (*least)->rank() > 0 || (*least)->bytes_held() == 0) return;
    (*least)->dismiss("the master has too little memory for a request this long");
  }
}

void OperatorServer::take(const std::shared_ptr<Client>& client) {
  if (client->stops()) return client->have_handled();
  (client->drives() ? driving_ : others_).push_back(client);
  serve_waiting();
}

void OperatorServer::serve_waiting() {
  for (auto* queue : {&driving_, &others_}) {
    while (turns_ > 0 && !queue->empty()) {
      const auto client = queue->front().lock();
      queue->pop_front();
      if (!client || !client->is_open()) continue;
      --turns_;
      client->in_memory([&] { client->have_handled(); });
    }
  }
  const bool waits = turns_ < kRequestsPerMs;
  if (!waits || next_turns_.expiry() > asio::steady_timer::clock_type::now()) return;
  next_turns_.expires_after(std::chrono::milliseconds(1));
  next_turns_.async_wait([this, running = std::weak_ptr(running_)](Error) {
    if (running.expired()) return;
    turns_ = kRequestsPerMs;
    serve_waiting();
  });
}

}  // namespace handrail
