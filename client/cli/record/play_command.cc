#include "client/cli/record/play_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

namespace handrail {
namespace {

// Beside this program.
std::string console_program() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  return (own.parent_path() / "handrail-console").string();
}

}  // namespace

Status become_player(const PlayWords& words) {
  std::string program = console_program();
  std::vector<std::string> line = {program, "--recording", words.file, "--listen",
                                   words.listen.value_or("127.0.0.1:0")};
  if (words.json) line.push_back("--json");
  std::vector<char*> argv;
  for (std::string& word : line) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  return Status::error("cannot start " + program + ": " + std::strerror(errno));
}

}  // namespace handrail
