#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "client/doctor/gather.h"

namespace handrail {
namespace {

namespace fs = std::filesystem;

std::string whole(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

// Scheduling policy of a thread: field 41 of its stat (proc(5)); the name before may hold anything.
int policy_of(const fs::path& thread) {
  const std::string text = whole(thread / "stat");
  const std::size_t name_ends = text.rfind(')');
  if (name_ends == std::string::npos) return -1;
  std::istringstream fields(text.substr(name_ends + 1));
  std::string field;
  constexpr int kPolicy = 41, kFirst = 3;
  for (int i = kFirst; i <= kPolicy; ++i) {
    if (!(fields >> field)) return -1;
  }
  return std::atoi(field.c_str());
}

bool has_locked_memory(const fs::path& process) {
  const std::string status = whole(process / "status");
  const std::size_t at = status.find("VmLck:");
  return at != std::string::npos && std::atol(status.c_str() + at + 6) > 0;
}

// "handrail-slave", "--link", "any": each ends with a zero.
bool is_told_a_link(const fs::path& process) {
  const std::string line = whole(process / "cmdline");
  const std::string option("\0--link", 7);
  const std::size_t at = line.find(option);
  return at != std::string::npos &&
         (line[at + option.size()] == '\0' || line[at + option.size()] == '=');
}

}  // namespace

std::vector<LocalProgram> local_programs() {
  std::vector<LocalProgram> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc", error)) {
    const fs::path& process = entry.path();
    const int number = std::atoi(process.filename().c_str());
    struct stat owner {};
    if (number <= 0 || ::stat(process.c_str(), &owner) != 0 || owner.st_uid != ::geteuid()) {
      continue;
    }
    std::string name = whole(process / "comm");
    name.erase(std::remove(name.begin(), name.end(), '\n'), name.end());
    if (name != "handrail-master" && name != "handrail-slave") continue;
    LocalProgram program{name, number, is_told_a_link(process), 0, has_locked_memory(process)};
    for (const fs::directory_entry& thread : fs::directory_iterator(process / "task", error)) {
      program.fifo_threads += policy_of(thread.path()) == SCHED_FIFO ? 1 : 0;
    }
    out.push_back(program);
  }
  return out;
}

}  // namespace handrail
