// A connection to an operator socket that says what no proper client would.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "proto/operator.pb.h"
#include "server/base/length_prefix.h"

namespace handrail {

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
  // The other side has ended the connection, and nothing waits to be read.
  bool is_over() const {
    char next = 0;
    return ::recv(fd_, &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
  }
  // Nothing more is said.
  void end() { ::shutdown(fd_, SHUT_WR); }
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
