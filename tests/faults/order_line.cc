#include "tests/faults/order_line.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

namespace handrail::faults {
namespace {

constexpr time_t kAnswers = 20;  // longer than any order takes on a busy machine [s]

}  // namespace

OrderLine::~OrderLine() {
  if (fd_ >= 0) ::close(fd_);
}

bool OrderLine::connect(const std::string& path) {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (path.size() >= sizeof to.sun_path) return false;
  std::memcpy(to.sun_path, path.c_str(), path.size());
  if (fd_ < 0) fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{kAnswers, 0};
  (void)::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return ::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
}

Result<std::string> OrderLine::order(const std::string& line) {
  const std::string sent = line + "\n";
  (void)!::send(fd_, sent.data(), sent.size(), MSG_NOSIGNAL);
  std::string answer;
  for (char c = 0; ::recv(fd_, &c, 1, 0) == 1 && c != '\n';) answer += c;
  if (answer == "ok") return std::string();
  if (answer.starts_with("ok ")) return answer.substr(3);
  return Status::error("order '" + line.substr(0, 60) +
                       "': " + (answer.empty() ? "no answer" : answer));
}

}  // namespace handrail::faults
