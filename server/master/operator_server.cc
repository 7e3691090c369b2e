#include "server/master/operator_server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>

#include "server/base/clock.h"
#include "server/base/length_prefix.h"

namespace handrail {

namespace asio = boost::asio;
using Error = boost::system::error_code;
using Socket = asio::local::stream_protocol::socket;

namespace {

pb::Reply refusal(const std::string& reason) {
  pb::Reply reply;
  reply.set_done(false);
  reply.set_reason(reason);
  return reply;
}

// An order switched off, as in `engage: false`, is none.
bool has_order(const pb::Request& r) {
  switch (r.order_case()) {
    case pb::Request::kStatus:
      return r.status();
    case pb::Request::kEngage:
      return r.engage();
    case pb::Request::kDisengage:
      return r.disengage();
    case pb::Request::kStop:
      return r.stop();
    case pb::Request::kReset:
      return r.reset();
    case pb::Request::kHoldAlive:
      return r.hold_alive();
    case pb::Request::ORDER_NOT_SET:
      return false;
    default:
      return true;
  }
}

}  // namespace

// One connection: wait for a frame, read it, have it handled, answer, again.
class OperatorServer::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Socket socket, OperatorHandler& handler)
      : socket_(std::move(socket)), timer_(socket_.get_executor()), handler_(handler) {}

  void await_frame() {
    idle_since_ = monotonic_now();
    socket_.async_wait(Socket::wait_read, [self = shared_from_this()](Error error) {
      if (error) return;
      self->idle_since_ = kForever;
      self->read_header();
    });
  }
  // Answers and, with `last`, closes afterwards.
  void answer(const pb::Reply& reply, bool last) {
    out_ = framed(reply.SerializeAsString());
    limit_time();
    asio::async_write(socket_, asio::buffer(out_),
                      [self = shared_from_this(), last](Error error, std::size_t) {
                        self->timer_.cancel();
                        if (error || last) return self->close();
                        self->await_frame();
                      });
  }
  void close() {
    Error ignored;
    timer_.cancel();
    socket_.close(ignored);
  }
  bool is_open() const { return socket_.is_open(); }
  Nanos idle_since() const { return idle_since_; }

 private:
  class Ticket;

  void limit_time() {
    timer_.expires_after(std::chrono::nanoseconds(kPatience));
    timer_.async_wait([weak = weak_from_this()](Error error) {
      const auto self = weak.lock();
      if (!error && self) self->close();
    });
  }
  void read_header() {
    limit_time();
    asio::async_read(socket_, asio::buffer(header_),
                     [self = shared_from_this()](Error error, std::size_t) {
                       if (error) return self->close();
                       self->read_body();
                     });
  }
  void read_body() {
    const std::uint32_t size = frame_size(header_.data());
    if (size > kMaxFrame) {
      const std::string text = std::to_string(size);
      return answer(refusal("a request of " + text + " bytes, expected at most 65536"), true);
    }
    body_.resize(size);
    asio::async_read(socket_, asio::buffer(body_),
                     [self = shared_from_this()](Error error, std::size_t) {
                       if (error) return self->close();
                       self->timer_.cancel();
                       self->obey();
                     });
  }
  void obey();

  Socket socket_;
  asio::steady_timer timer_;
  OperatorHandler& handler_;
  Nanos idle_since_ = kForever;  // kForever while a request is in progress
  std::array<char, kFrameHeader> header_{};
  std::string body_;
  std::string out_;
};

// What a handler holds of a client: the right to answer once. It does not keep the client alive, so
// a handler may outlive server and io_context.
class OperatorServer::Client::Ticket {
 public:
  explicit Ticket(std::weak_ptr<Client> client) : client_(std::move(client)) {}
  ~Ticket() {
    in_io_thread([](Client& client) { client.close(); });
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
    asio::post(client->socket_.get_executor(), [client, f = std::move(f)] { f(*client); });
  }
  std::weak_ptr<Client> client_;
  std::atomic<bool> used_{false};
};

void OperatorServer::Client::obey() {
  if (!is_open()) return;
  pb::Request request;
  if (!request.ParseFromString(body_)) return answer(refusal("the request is garbled"), true);
  if (!has_order(request)) return answer(refusal("the request holds no order"), true);
  const auto ticket = std::make_shared<Ticket>(weak_from_this());
  handler_.handle(request, [ticket](pb::Reply reply) { ticket->answer(std::move(reply)); });
}

OperatorServer::OperatorServer(asio::io_context& io, OperatorHandler& handler)
    : handler_(handler), acceptor_(io), pause_(io) {}

OperatorServer::~OperatorServer() { stop(); }

Status OperatorServer::start(const std::string& path) {
  if (Status status = file_.claim(path); !status) return status;
  acceptor_.assign(asio::local::stream_protocol(), file_.release());
  running_ = std::make_shared<int>();
  accept();
  return Status::ok();
}

void OperatorServer::stop() {
  Error ignored;
  running_.reset();
  pause_.cancel();
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
  acceptor_.async_accept([this, running = std::weak_ptr(running_)](Error error, Socket socket) {
    if (running.expired()) return;
    if (!error) {
      admit(std::move(socket));
      return accept();
    }
    // Out of descriptors, most likely: asking again at once would only spin.
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this, running](Error) {
      if (!running.expired()) accept();
    });
  });
}

void OperatorServer::admit(Socket socket) {
  const auto client = std::make_shared<Client>(std::move(socket), handler_);
  if (!make_room()) {
    return client->answer(refusal("16 clients are connected already"), true);
  }
  clients_.push_back(client);
  client->await_frame();
}

// True when one more client may stay, if need be in place of the one silent longest.
bool OperatorServer::make_room() {
  std::erase_if(clients_, [](const auto& client) { return !client->is_open(); });
  if (clients_.size() < kMaxClients) return true;
  Client* oldest = clients_.front().get();
  for (const auto& client : clients_) {
    if (client->idle_since() < oldest->idle_since()) oldest = client.get();
  }
  if (oldest->idle_since() > monotonic_now() - kIdle) return false;
  oldest->close();
  return true;
}

}  // namespace handrail
