#include "client/api/operator_client.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/system_error.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>

#include "server/base/clock.h"
#include "server/base/folder_owner.h"
#include "server/base/length_prefix.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

// Between two looks whether the call is cancelled: Ctrl-C feels immediate.
constexpr Nanos kLook = 50 * kMillisecond;

}  // namespace

struct OperatorClient::Connection {
  boost::asio::io_context io;
  boost::asio::local::stream_protocol::socket stream{io};
};

OperatorClient::OperatorClient(std::string socket_path, std::string as, bool (*cancelled)())
    : path_(std::move(socket_path)), as_(std::move(as)), cancelled_(cancelled) {}
OperatorClient::~OperatorClient() = default;

template <typename Start>
Status OperatorClient::await(Nanos deadline, Start start) {
  std::optional<boost::system::error_code> ended;
  start([&ended](boost::system::error_code error, std::size_t) { ended = error; });
  boost::asio::io_context& io = connection_->io;
  std::string gave_up;
  while (!ended) {
    const Nanos left = deadline - monotonic_now();
    if (gave_up.empty()) {
      if (left <= 0) gave_up = "no answer in time";
      if (cancelled_ != nullptr && cancelled_()) gave_up = "interrupted";
      boost::system::error_code ignored;
      if (!gave_up.empty()) connection_->stream.close(ignored);  // ends what was begun
    }
    io.restart();
    // Asio runs nothing at all in a time of zero, not even what is ready.
    io.run_one_for(std::chrono::nanoseconds(std::clamp<Nanos>(left, kMillisecond, kLook)));
  }
  if (!gave_up.empty()) return failure(gave_up);
  if (!*ended) return Status::ok();
  namespace error = boost::asio::error;
  const bool closed =
      *ended == error::eof || *ended == error::broken_pipe || *ended == error::connection_reset;
  return Status::error("no master on " + path_ + ": " +
                       (closed ? "it closed the connection" : ended->message()));
}

Result<pb::Reply> OperatorClient::call(const pb::Request& order, Nanos patience) {
  const Nanos deadline = monotonic_now() + patience;
  pb::Request request = order;
  if (!request.has_as() && !as_.empty()) request.set_as(as_);
  const std::string payload = request.SerializeAsString();
  if (payload.size() > kMaxFrame) return failure("the request is larger than 64 KiB");
  if (!connection_) {
    if (Status status = connect(deadline); !status) return status;
  }
  const std::string frame = framed(payload);
  const auto write = [&](auto done) {
    boost::asio::async_write(connection_->stream, boost::asio::buffer(frame), done);
  };
  const auto read = [&](auto to) {
    return [this, to](auto done) { boost::asio::async_read(connection_->stream, to, done); };
  };
  // A master that refuses the connection answers and closes, perhaps before the request is out.
  const Status sent = await(deadline, write);
  if (!connection_) return sent;
  std::array<char, kFrameHeader> header{};
  if (Status s = await(deadline, read(boost::asio::buffer(header))); !s) {
    close();
    return sent ? s : sent;
  }
  const std::uint32_t size = frame_size(header.data());
  if (size > kMaxFrame) return failure("the reply is larger than 64 KiB");
  std::string body(size, '\0');
  if (Status s = await(deadline, read(boost::asio::buffer(body))); !s) {
    close();
    return s;
  }
  pb::Reply reply;
  if (!reply.ParseFromString(body)) return failure("the reply is garbled");
  return reply;
}

void OperatorClient::close() noexcept { connection_.reset(); }

Status OperatorClient::failure(const std::string& what) {
  close();
  return Status::error("no master on " + path_ + ": " + what);
}

Status OperatorClient::connect(Nanos deadline) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.empty() || path_.size() >= sizeof(address.sun_path)) {
    return failure("the path has " + std::to_string(path_.size()) + " bytes, expected 1 to " +
                   std::to_string(sizeof(address.sun_path) - 1));
  }
  std::copy(path_.begin(), path_.end(), address.sun_path);
  boost::system::error_code error;
  try {
    connection_ = std::make_unique<Connection>();
  } catch (const boost::system::system_error& none) {  // no descriptors are left for its reactor
    error = none.code();
  }
  if (!error) connection_->stream.open({}, error);
  if (!error) connection_->stream.non_blocking(true, error);
  if (error) return failure(error.message());
  // Not by Asio: it takes the full queue of a busy master, for which there is nothing to poll, for
  // a connection on its way.
  const int fd = connection_->stream.native_handle();
  ::fcntl(fd, F_SETFD, FD_CLOEXEC);  // Asio does not: a program started now would keep it open
  while (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    if (errno != EAGAIN && errno != EINTR) {
      const int cause = errno;
      if (cause == ENOENT) return failure(std::string("no such socket; ") + kStartMaster);
      if (cause != ECONNREFUSED) return failure(std::strerror(cause));
      return failure(std::string("nobody listens on the socket; ") + kStartMaster);
    }
    if (cancelled_ != nullptr && cancelled_()) return failure("interrupted");
    if (monotonic_now() >= deadline) return failure("it does not accept connections");
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return check_peer();
}

Status OperatorClient::check_peer() {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(connection_->stream.native_handle(), SOL_SOCKET, SO_PEERCRED, &peer, &size) !=
      0) {
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

ExitCode exit_code(const Result<pb::Reply>& reply) {
  if (!reply) return kExitNoMaster;
  return reply->done() ? kExitDone : kExitRefused;
}

}  // namespace handrail
