#include "server/link/unix_transport.h"

#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>

#include "server/base/own_places.h"

namespace handrail {
namespace {

// One sender and no more: descriptors that somebody hands over find no room, and the kernel closes
// them.
constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(ucred));

}  // namespace

std::optional<ucred> sender_of(const msghdr& message) noexcept {
  for (const cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(part))) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_CREDENTIALS) continue;
    if (part->cmsg_len != CMSG_LEN(sizeof(ucred))) continue;
    ucred out{};
    std::memcpy(&out, CMSG_DATA(part), sizeof out);
    return out;
  }
  return std::nullopt;
}

std::string_view UnixTransport::Address::path() const noexcept {
  constexpr std::size_t kStart = offsetof(sockaddr_un, sun_path);
  if (size <= kStart) return {};
  return {at.sun_path, ::strnlen(at.sun_path, size - kStart)};
}

Status UnixTransport::open() {
  close();
  const bool leads = end_ == End::kMaster;
  const std::string own = leads ? master_socket(slave_path_, ::getpid()) : slave_path_;
  if (Status claimed = file_.claim(own); !claimed) return claimed;
  own_user_ = ::geteuid();
  const int fd = file_.release();
  boost::system::error_code error;
  socket_.assign(fd, error);
  if (error) {
    ::close(fd);
    file_.remove();
    return Status::error("link socket " + own + ": cannot be waited for: " + error.message());
  }
  if (leads) {
    // Its folder is the same as ours, so that it has no links either.
    const std::string& at = file_.path();
    const std::size_t length = at.size() - (own.size() - slave_path_.size());
    peer_.at.sun_family = AF_UNIX;
    at.copy(peer_.at.sun_path, length);
    peer_.size = sizeof peer_.at;
  }
  return Status::ok();
}

void UnixTransport::on_readable(std::function<void()> readable) {
  readable_ = std::move(readable);
  wait_readable();
}

void UnixTransport::wait_readable() {
  socket_.async_wait(boost::asio::posix::descriptor_base::wait_read,
                     [this](const boost::system::error_code& error) {
                       if (error) return;
                       readable_();
                       wait_readable();
                     });
}

void UnixTransport::close() noexcept {
  boost::system::error_code ignored;
  socket_.close(ignored);
  file_.remove();
  peer_ = sender_ = {};
  sender_may_speak_ = false;
  peer_process_ = -1;
  peer_name_ = {};
}

std::optional<Transport::Arrival> UnixTransport::receive(std::span<std::uint8_t> buffer) noexcept {
  iovec part{buffer.data(), buffer.size()};
  alignas(cmsghdr) std::array<std::byte, kControlBytes> control;
  msghdr message{};
  message.msg_name = &sender_.at;
  message.msg_namelen = sizeof sender_.at;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket_.native_handle(), &message, MSG_DONTWAIT);
  if (size < 0) return std::nullopt;
  sender_.size = message.msg_namelen;
  const std::optional<ucred> who = sender_of(message);
  sender_process_ = who ? who->pid : 0;
  // Without a path nobody can be answered.
  const std::string_view from = sender_.path();
  const bool there = end_ == End::kMaster ? from == peer_.path() : !from.empty();
  sender_may_speak_ = who && who->uid == own_user_ && there;
  return Arrival{static_cast<std::size_t>(size), sender_may_speak_};
}

void UnixTransport::adopt_sender() noexcept {
  if (!sender_may_speak_) return;
  if (end_ == End::kSlave) peer_ = sender_;
  if (sender_process_ == peer_process_) return;
  peer_process_ = sender_process_;
  // A process that is hidden from us, as in another container, has no number.
  if (peer_process_ == 0) {
    peer_name_ = fixed_text<LeaderName>("a process on this computer");
  } else {
    std::snprintf(peer_name_.data(), peer_name_.size(), "process %d on this computer",
                  static_cast<int>(peer_process_));
  }
}

bool UnixTransport::send(std::span<const std::uint8_t> bytes) noexcept {
  return send_to(bytes, peer_);
}

bool UnixTransport::answer(std::span<const std::uint8_t> bytes) noexcept {
  return sender_may_speak_ && send_to(bytes, sender_);
}

bool UnixTransport::send_to(std::span<const std::uint8_t> bytes, const Address& to) noexcept {
  if (to.size == 0) return false;
  const ssize_t sent =
      ::sendto(socket_.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
               reinterpret_cast<const sockaddr*>(&to.at), to.size);
  return sent == static_cast<ssize_t>(bytes.size());
}

}  // namespace handrail
