// The configuration files. The first byte says whose: of the master, the slave or the rig; the rest
// is the file.
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "devices/rig/rig_options_io.h"
#include "server/scene/config_io.h"
#include "tests/fuzz/expect_error.h"

namespace handrail {
namespace {

using fuzz::require;

// A file in memory: the loaders are tried as they are, with their reading.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : fd_(::memfd_create("config", MFD_CLOEXEC)) {
    require(fd_ >= 0 && ::write(fd_, text.data(), text.size()) == static_cast<ssize_t>(text.size()),
            "a file in memory can be had");
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

}  // namespace

HANDRAIL_FUZZ(config) {
  fuzz::Input input(bytes);
  const int whose = input.take<std::uint8_t>() % 3;
  const MemoryFile file(fuzz::text_of(input.take_bytes(bytes.size())));
  std::string error;
  if (whose == 0) {
    const auto config = load_master_config(file.path());
    if (!config) return fuzz::require_error_at(file.path() + ":", config.message());
    require(config->has_slave() || socket_path_problem(config->link_socket()).empty(),
            "a socket's path fits");
    require(socket_path_problem(config->operator_socket()).empty(), "a socket's path fits");
  } else if (whose == 1) {
    const auto config = load_slave_config(file.path());
    if (!config) return fuzz::require_error_at(file.path() + ":", config.message());
    require(config->has_link_address() || config->has_link_port() ||
                socket_path_problem(config->link_socket()).empty(),
            "a socket's path fits");
    require(config->robot().port() != 0, "a controller has a port");
  } else {
    const auto config = load_rig_config(file.path());
    if (!config) return fuzz::require_error_at(file.path() + ":", config.message());
    require(config->robot_port() <= UINT16_MAX, "a port is one");
  }
}

}  // namespace handrail
