#include "tests/emulator/fd_message.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace handrail::emulator {
namespace {

// Room for a descriptor and the sender's credentials.
struct Attachments {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int)) + CMSG_SPACE(sizeof(ucred))> bytes{};
};

}  // namespace

bool send_message(int socket, const FdMessage& message) {
  std::string bytes;
  for (const std::string& word : message.words) bytes.append(word).push_back('\0');
  if (bytes.size() > kLongestMessage) return false;
  iovec piece{bytes.data(), bytes.size()};
  msghdr header{};
  header.msg_iov = &piece;
  header.msg_iovlen = 1;
  Attachments attached;
  if (message.fd >= 0) {
    header.msg_control = attached.bytes.data();
    header.msg_controllen = CMSG_SPACE(sizeof(int));
    cmsghdr* const first = CMSG_FIRSTHDR(&header);
    first->cmsg_level = SOL_SOCKET;
    first->cmsg_type = SCM_RIGHTS;
    first->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(first), &message.fd, sizeof(int));
  }
  ssize_t sent = 0;
  do {
    sent = ::sendmsg(socket, &header, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes.size());
}

std::optional<FdMessage> receive_message(int socket) {
  std::string bytes(kLongestMessage, '\0');
  iovec piece{bytes.data(), bytes.size()};
  Attachments attached;
  msghdr header{};
  header.msg_iov = &piece;
  header.msg_iovlen = 1;
  header.msg_control = attached.bytes.data();
  header.msg_controllen = attached.bytes.size();
  ssize_t size = 0;
  do {
    size = ::recvmsg(socket, &header, MSG_CMSG_CLOEXEC);
  } while (size < 0 && errno == EINTR);
  if (size <= 0) return std::nullopt;
  FdMessage out;
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SCM_RIGHTS) std::memcpy(&out.fd, CMSG_DATA(part), sizeof(int));
    if (part->cmsg_type != SCM_CREDENTIALS) continue;
    ucred who{};
    std::memcpy(&who, CMSG_DATA(part), sizeof who);
    out.from = who.pid;
  }
  for (std::size_t start = 0; start < static_cast<std::size_t>(size);) {
    const std::size_t end = bytes.find('\0', start);
    out.words.push_back(bytes.substr(start, end - start));
    start = end + 1;
  }
  return out;
}

}  // namespace handrail::emulator
