#include "server/keys/host_port.h"

#include <charconv>

#include "server/base/plain_text.h"

namespace handrail {

Result<HostPort> parse_host(const std::string& text, std::uint16_t port, unsigned least) {
  std::string expected = "'";
  expected.append(shown(text, 80))
      .append("': expected a name or an address, and a port of ")
      .append(std::to_string(least))
      .append(" to 65535 after a colon if it is not ")
      .append(std::to_string(port))
      .append(": cell.example.org, 192.0.2.7:47002, [2001:db8::7]:47002");
  const Status wrong = Status::error(expected);
  std::string host = text, number;
  const std::size_t colon = text.rfind(':');
  const bool bracket = !text.empty() && text.front() == '[';
  if (bracket) {
    const std::size_t end = text.find(']');
    if (end == std::string::npos) return wrong;
    host = text.substr(1, end - 1);
    if (end + 1 < text.size()) {
      if (text[end + 1] != ':') return wrong;
      number = text.substr(end + 2);
      if (number.empty()) return wrong;
    }
  } else if (colon != std::string::npos && text.find(':') == colon) {
    host = text.substr(0, colon);
    number = text.substr(colon + 1);
    if (number.empty()) return wrong;
  }
  unsigned value = port;
  if (!number.empty()) {
    const char* end = number.data() + number.size();
    const auto [at, error] = std::from_chars(number.data(), end, value);
    if (error != std::errc() || at != end || value < least || value > 65535) return wrong;
  }
  if (host.empty() || host.size() > 253 || host.find_first_of(" \t\r\n/\\") != std::string::npos) {
    return wrong;
  }
  return HostPort{host, static_cast<std::uint16_t>(value)};
}

}  // namespace handrail
