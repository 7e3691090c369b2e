#include "devices/udp/udp_table.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace handrail {

bool udp_speaks_with(const std::string& table, const std::string& address, std::uint16_t port) {
  in_addr parsed{};
  if (::inet_pton(AF_INET, address.c_str(), &parsed) != 1) return false;
  // The kernel writes the address as a number of this computer's, the port as it is said.
  std::array<char, 16> remote{};
  std::snprintf(remote.data(), remote.size(), "%08X:%04X", parsed.s_addr, port);
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);  // names of the columns
  while (std::getline(in, line)) {
    std::istringstream columns(line);
    std::string number, ours, theirs;
    if (columns >> number >> ours >> theirs && theirs == remote.data()) return true;
  }
  return false;
}

}  // namespace handrail
