// A socket on this computer: of a master's operators, or of the simulated rig.
#include "client/api/master_stream.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "server/base/clock.h"
#include "server/base/folder_owner.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

class SocketStream final : public MasterStream {
 public:
  SocketStream(std::string path, SocketWords words, Cancelled cancelled)
      : MasterStream(std::move(words.place), cancelled),
        path_(std::move(path)),
        start_(std::move(words.start)) {}

  Status connect(Nanos deadline) override;

 private:
  void begin_write(boost::asio::const_buffer bytes, Done done) override {
    boost::asio::async_write(stream_, bytes, std::move(done));
  }
  void begin_read(boost::asio::mutable_buffer to, Done done) override {
    boost::asio::async_read(stream_, to, std::move(done));
  }
  void close() noexcept override {
    boost::system::error_code ignored;
    stream_.close(ignored);
  }
  // Who listens is root, this user, or who owns the folder that nobody else can put there.
  Status check_peer();

  const std::string path_, start_;
  boost::asio::local::stream_protocol::socket stream_{io_};
};

Status SocketStream::connect(Nanos deadline) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.empty() || path_.size() >= sizeof(address.sun_path)) {
    return failure("the path has " + std::to_string(path_.size()) + " bytes, expected 1 to " +
                   std::to_string(sizeof(address.sun_path) - 1));
  }
  std::copy(path_.begin(), path_.end(), address.sun_path);
  boost::system::error_code error;
  stream_.open({}, error);
  if (!error) stream_.non_blocking(true, error);
  if (error) return failure(error.message());
  // Not by Asio: it takes the full queue of a busy master, for which there is nothing to poll, for
  // a connection on its way.
  const int fd = stream_.native_handle();
  ::fcntl(fd, F_SETFD, FD_CLOEXEC);  // Asio does not: a program started now would keep it open
  while (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    if (errno != EAGAIN && errno != EINTR) {
      const int cause = errno;
      if (cause == ENOENT) return failure("no such socket; " + start_);
      if (cause != ECONNREFUSED) return failure(std::strerror(cause));
      return failure("nobody listens on the socket; " + start_);
    }
    if (is_cancelled()) return failure("interrupted");
    if (monotonic_now() >= deadline) return failure("it does not accept connections");
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return check_peer();
}

Status SocketStream::check_peer() {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(stream_.native_handle(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return failure(std::strerror(errno));
  }
  if (peer.uid == 0 || peer.uid == ::geteuid()) return Status::ok();
  const auto parent = [](const std::filesystem::path& p) {
    return p.has_parent_path() ? p.parent_path() : std::filesystem::path(".");
  };
  const std::filesystem::path folder = parent(std::filesystem::absolute(path_));
  const Result<FolderOwner> owner = folder_owner(folder), above = keeper_of(parent(folder));
  std::string why;
  if (!owner) {
    why = owner.message();
  } else if (owner->user != peer.uid) {
    why = folder.string() + " is a folder of " + owner->text;
  } else if (!above) {
    why = above.message();
  } else if (above->user != 0 && above->user != peer.uid) {
    why = parent(folder).string() + " is a folder of " + above->text + ", who could replace it";
  } else {
    return Status::ok();
  }
  const std::string self = ::geteuid() == 0 ? "root" : user_text(::geteuid()) + ", root";
  return failure(user_text(peer.uid) + " listens there, expected " + self +
                 " or the owner of a folder that nobody else can replace; " + why);
}

}  // namespace

std::unique_ptr<MasterStream> make_socket_stream(const std::string& path, SocketWords words,
                                                 MasterStream::Cancelled cancelled) {
  return std::make_unique<SocketStream>(path, std::move(words), cancelled);
}

}  // namespace handrail
