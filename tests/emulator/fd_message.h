// Messages between the emulator and the first process of a side: words, and with them a descriptor.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace handrail::emulator {

// Words without zeros in them; at most kLongestMessage bytes in all.
struct FdMessage {
  std::vector<std::string> words;
  int fd = -1;     // to be closed by whoever receives it
  pid_t from = 0;  // who sent it, as the receiver's namespace numbers it; filled in by receive()
};

inline constexpr std::size_t kLongestMessage = 64 * 1024;

// Over a socket of SOCK_SEQPACKET; false: the other end has gone, or it is too long.
bool send_message(int socket, const FdMessage& message);
// Waits for one; nullopt: the other end has gone. `from` needs SO_PASSCRED set on the socket.
std::optional<FdMessage> receive_message(int socket);

}  // namespace handrail::emulator
