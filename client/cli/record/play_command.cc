#include "client/cli/record/play_command.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

// Beside this program.
std::string console_program() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  return (own.parent_path() / "handrail-console").string();
}

bool is_port(const std::string& text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [rest, wrong] = std::from_chars(text.data(), end, port);
  return wrong == std::errc() && rest == end;
}

}  // namespace

Status become_player(const PlayWords& words) {
  if (words.address &&
      (words.address->empty() || words.address->find_first_of(":/ ") != std::string::npos)) {
    return Status::error("--address: '" + shown(*words.address) +
                         "', expected an address of this computer, such as "
                         "127.0.0.1, without a port");
  }
  if (words.port && !is_port(*words.port)) {
    return Status::error("--port: '" + shown(*words.port) +
                         "', expected 0, any that is free, to 65535");
  }
  std::string program = console_program();
  std::vector<std::string> line = {
      program, "--recording", words.file, "--listen",
      words.address.value_or("127.0.0.1") + ":" + words.port.value_or("0")};
  if (words.json) line.push_back("--json");
  std::vector<char*> argv;
  for (std::string& word : line) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  return Status::error("cannot start " + program + ": " + std::strerror(errno));
}

}  // namespace handrail
