#include "server/base/doorbell.h"

#include <sys/eventfd.h>
#include <unistd.h>

namespace handrail {

Doorbell::Doorbell() noexcept : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

Doorbell::~Doorbell() {
  if (fd_ >= 0) ::close(fd_);
}

void Doorbell::ring() const noexcept { (void)::eventfd_write(fd_, 1); }

bool Doorbell::answer() const noexcept {
  eventfd_t rings = 0;
  return ::eventfd_read(fd_, &rings) == 0;
}

}  // namespace handrail
