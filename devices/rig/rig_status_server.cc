#include "devices/rig/rig_status_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "server/base/clock.h"
#include "server/base/length_prefix.h"
#include "server/link/path_socket.h"

namespace handrail {

namespace asio = boost::asio;
using Error = boost::system::error_code;
using Socket = asio::local::stream_protocol::socket;

namespace {

constexpr auto kHearAgain = std::chrono::milliseconds(50);  // the feed holds a second
constexpr Nanos kPlayPatience = 500 * kMillisecond;         // of a thread that comes by each 1 ms

bool is_ours(int fd) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  return peer.uid == ::geteuid() || peer.uid == 0;
}

}  // namespace

struct RigStatusServer::Impl {
  // One connection: gather an order, answer it, again.
  class Client : public std::enable_shared_from_this<Client> {
   public:
    Client(Socket socket, Impl& server)
        : socket_(std::move(socket)), timer_(socket_.get_executor()), server_(server) {}

    void read() {
      heard_ = monotonic_now();
      socket_.async_read_some(asio::buffer(part_),
                              [self = shared_from_this()](Error error, std::size_t count) {
                                if (error) return self->close();
                                self->in_.append(self->part_.data(), count);
                                self->take();
                              });
    }
    void close() {
      Error ignored;
      timer_.cancel();
      socket_.close(ignored);
    }
    // Says why and closes, whether anybody reads it or not.
    void dismiss(const std::string& why) {
      Error ignored;
      socket_.non_blocking(true, ignored);
      socket_.send(asio::buffer(framed(rig_refusal(why))), MSG_NOSIGNAL, ignored);
      close();
    }
    bool is_open() const { return socket_.is_open(); }
    int handle() { return socket_.native_handle(); }
    Nanos heard() const { return heard_; }

   private:
    void limit_time() {
      timer_.expires_after(std::chrono::nanoseconds(kRigPatience));
      timer_.async_wait([weak = weak_from_this()](Error error) {
        const auto self = weak.lock();
        if (!error && self) self->close();
      });
    }
    // The first order of what has come, if it is whole.
    void take() {
      if (in_.size() >= kFrameHeader && frame_size(in_.data()) > kMostOrder) {
        return dismiss("an order of " + std::to_string(frame_size(in_.data())) +
                       " bytes, expected at most " + std::to_string(kMostOrder));
      }
      if (in_.size() < kFrameHeader || in_.size() - kFrameHeader < frame_size(in_.data())) {
        if (!in_.empty() && !std::exchange(rest_is_timed_, true)) limit_time();
        return read();
      }
      const std::size_t size = frame_size(in_.data());
      server_.hear();
      out_ = framed(server_.board.answer({in_.data() + kFrameHeader, size}));
      in_.erase(0, kFrameHeader + size);
      rest_is_timed_ = false;
      limit_time();
      asio::async_write(socket_, asio::buffer(out_),
                        [self = shared_from_this()](Error error, std::size_t) {
                          self->timer_.cancel();
                          if (error) return self->close();
                          self->take();
                        });
    }

    Socket socket_;
    asio::steady_timer timer_;
    Impl& server_;
    Nanos heard_ = 0;
    std::array<char, kMostOrder> part_{};
    std::string in_, out_;
    bool rest_is_timed_ = false;
  };

  Impl(RigFeed& rig, std::string scene, RigBoard::FindWorkpiece find)
      : feed(rig), board(std::move(scene), std::move(find), [this](const Workpiece& piece) {
          auto played = feed.play(piece, kPlayPatience);
          // What was told before that is of another workpiece.
          for (RigMoment before; feed.hear(before);) continue;
          return played;
        }) {}

  void hear() {
    for (RigMoment moment; feed.hear(moment);) board.hear(moment);
  }
  void hear_again() {
    hear();
    hearing.expires_after(kHearAgain);
    hearing.async_wait([this](Error error) {
      if (!error) hear_again();
    });
  }
  void accept() {
    acceptor.async_accept([this](Error error, Socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {  // no descriptor for who waits: asking again at once would only spin
        pause.expires_after(kHearAgain);
        return pause.async_wait([this](Error stopped) {
          if (!stopped) accept();
        });
      }
      take_in(std::move(socket));
      accept();
    });
  }
  void take_in(Socket socket) {
    std::erase_if(clients, [](const auto& client) { return !client->is_open(); });
    const auto client = std::make_shared<Client>(std::move(socket), *this);
    if (!is_ours(client->handle())) return client->dismiss("the rig is another user's");
    if (clients.size() >= kMostClients) {
      const auto longest =
          std::min_element(clients.begin(), clients.end(),
                           [](const auto& a, const auto& b) { return a->heard() < b->heard(); });
      (*longest)->dismiss("another client took your place: there is room for " +
                          std::to_string(kMostClients));
      clients.erase(longest);
    }
    clients.push_back(client);
    client->read();
  }

  RigFeed& feed;
  RigBoard board;
  asio::io_context io{1};
  PathSocket file{{SOCK_STREAM, "status socket", "another handrail-rig"}};
  asio::local::stream_protocol::acceptor acceptor{io};
  asio::steady_timer hearing{io}, pause{io};
  std::vector<std::shared_ptr<Client>> clients;
  std::thread thread;
};

RigStatusServer::RigStatusServer(RigFeed& feed, std::string scene, RigBoard::FindWorkpiece find)
    : impl_(std::make_unique<Impl>(feed, std::move(scene), std::move(find))) {}

RigStatusServer::~RigStatusServer() {
  impl_->io.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

Status RigStatusServer::start(const std::string& path) {
  if (Status claimed = impl_->file.claim(path); !claimed) return claimed;
  impl_->acceptor.assign(asio::local::stream_protocol(), impl_->file.release());
  impl_->hear_again();
  impl_->accept();
  impl_->thread = std::thread([this] { impl_->io.run(); });
  return Status::ok();
}

}  // namespace handrail
