// The plain link: a Unix datagram socket, between two programs of one user on one computer.
#pragma once

#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "server/base/fixed_text.h"
#include "server/link/path_socket.h"
#include "server/link/refusal.h"
#include "server/link/transport.h"

namespace handrail {

// Who sent a datagram, as the kernel says: of `message` with the control data of a socket that asks
// for it. Nothing where it says nothing. Real-time safe.
std::optional<ucred> sender_of(const msghdr& message) noexcept;

// A slave waits at its path; a master has one of its own beside it (master_socket) and talks to
// that slave, whichever program of this user has the path now. Neither encrypted nor signed: files
// and folder keep other users out, and of every datagram the kernel says which user sent it. Only
// this program's own counts; root does not, who can become that user. A full queue at the other end
// is a lost datagram: it holds net.unix.max_dgram_qlen and one more, the oldest.
class UnixTransport final : public ServedTransport {
 public:
  enum class End { kSlave, kMaster };

  // `io` is only used by on_readable() and must outlive this. `slave_path`: of at most 92 bytes,
  // without links too.
  UnixTransport(boost::asio::io_context& io, End end, std::string slave_path)
      : end_(end),
        slave_path_(std::move(slave_path)),
        file_({SOCK_DGRAM, "link socket", end == End::kSlave ? "another slave" : "another master"}),
        socket_(io) {}
  ~UnixTransport() override { close(); }

  Status open() override;
  void on_readable(std::function<void()> readable) override;
  void close() noexcept override;
  // The path that it is bound to.
  std::string place() const override { return file_.path(); }

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
  void adopt_sender() noexcept override;
  bool send(std::span<const std::uint8_t> bytes) noexcept override;
  bool answer(std::span<const std::uint8_t> bytes) noexcept override;
  std::string_view peer_name() const noexcept override { return text_of(peer_name_); }

 private:
  struct Address {
    sockaddr_un at{};
    socklen_t size = 0;  // 0: none
    // Empty: without a name in the file system. Real-time safe.
    std::string_view path() const noexcept;
  };

  void wait_readable();
  bool send_to(std::span<const std::uint8_t> bytes, const Address& to) noexcept;

  const End end_;
  const std::string slave_path_;
  uid_t own_user_ = 0;
  PathSocket file_;
  boost::asio::posix::stream_descriptor socket_;
  std::function<void()> readable_;
  Address peer_, sender_;  // of a master the peer is given
  bool sender_may_speak_ = false;
  pid_t sender_process_ = 0, peer_process_ = -1;
  LeaderName peer_name_{};
};

}  // namespace handrail
