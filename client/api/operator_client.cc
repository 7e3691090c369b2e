#include "client/api/operator_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "server/base/clock.h"
#include "server/base/folder_owner.h"
#include "server/base/length_prefix.h"

namespace handrail {
namespace {

// Between two looks whether the call is cancelled: Ctrl-C feels immediate [ms].
constexpr Nanos kLook = 50;

}  // namespace

Result<pb::Reply> OperatorClient::call(const pb::Request& order, Nanos patience) {
  const Nanos deadline = monotonic_now() + patience;
  pb::Request request = order;
  if (!request.has_as() && !as_.empty()) request.set_as(as_);
  const std::string payload = request.SerializeAsString();
  if (payload.size() > kMaxFrame) return failure("the request is larger than 64 KiB");
  if (fd_ < 0) {
    if (Status status = connect(deadline); !status) return status;
  }
  // A master that refuses the connection answers and closes, perhaps before the request is out.
  const Status sent = send_all(framed(payload), deadline);
  std::array<char, kFrameHeader> header{};
  if (Status s = receive_exactly(header.data(), header.size(), deadline); !s) {
    return sent ? s : sent;
  }
  const std::uint32_t size = frame_size(header.data());
  if (size > kMaxFrame) return failure("the reply is larger than 64 KiB");
  std::string body(size, '\0');
  if (Status s = receive_exactly(body.data(), body.size(), deadline); !s) return s;
  pb::Reply reply;
  if (!reply.ParseFromString(body)) return failure("the reply is garbled");
  return reply;
}

void OperatorClient::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

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
  fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0) return failure(std::strerror(errno));
  while (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    // A full queue of a busy master: there is nothing to poll for, so ask again.
    if (errno != EAGAIN && errno != EINTR) {
      const int cause = errno;
      return failure(cause == ENOENT         ? "no such socket; start handrail-master"
                     : cause == ECONNREFUSED ? "nobody listens on the socket; start handrail-master"
                                             : std::strerror(cause));
    }
    if (cancelled_ != nullptr && cancelled_()) return failure("interrupted");
    if (monotonic_now() >= deadline) return failure("it does not accept connections");
    ::poll(nullptr, 0, 5);
  }
  return check_peer();
}

Status OperatorClient::check_peer() {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(fd_, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
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

Status OperatorClient::wait(short events, Nanos deadline) {
  while (true) {
    const Nanos left = deadline - monotonic_now();
    if (left <= 0) return failure("no answer in time");
    if (cancelled_ != nullptr && cancelled_()) return failure("interrupted");
    pollfd entry{fd_, events, 0};
    const Nanos longest = cancelled_ != nullptr ? kLook : 60'000;
    const Nanos ms = std::min<Nanos>((left + kMillisecond - 1) / kMillisecond, longest);
    const int n = ::poll(&entry, 1, static_cast<int>(ms));
    if (n > 0) return Status::ok();
    if (n < 0 && errno != EINTR) return failure(std::strerror(errno));
  }
}

Status OperatorClient::send_all(const std::string& bytes, Nanos deadline) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::send(fd_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n >= 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN) {
      if (Status s = wait(POLLOUT, deadline); !s) return s;
    } else if (errno == EPIPE || errno == ECONNRESET) {
      return Status::error("no master on " + path_ + ": it closed the connection");
    } else if (errno != EINTR) {
      return failure(std::strerror(errno));
    }
  }
  return Status::ok();
}

Status OperatorClient::receive_exactly(char* out, std::size_t size, Nanos deadline) {
  for (std::size_t done = 0; done < size;) {
    if (fd_ < 0) return failure("the connection is closed");
    const ssize_t n = ::recv(fd_, out + done, size - done, 0);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n == 0) {
      return failure("it closed the connection");
    } else if (errno == EAGAIN) {
      if (Status s = wait(POLLIN, deadline); !s) return s;
    } else if (errno != EINTR) {
      return failure(std::strerror(errno));
    }
  }
  return Status::ok();
}

ExitCode exit_code(const Result<pb::Reply>& reply) {
  if (!reply) return kExitNoMaster;
  return reply->done() ? kExitDone : kExitRefused;
}

}  // namespace handrail
