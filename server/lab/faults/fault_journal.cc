#include "server/lab/faults/fault_journal.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "server/base/fnv.h"

namespace handrail {
namespace {

constexpr const char* kTitle = "handrail-lab faults, results of ";

Status cannot(const char* what, const std::string& path) {
  return Status::error(fmt::format("cannot {} {}: {}", what, path, std::strerror(errno)));
}

std::string line_of(const std::string& row, std::uint64_t seed, int index,
                    const FaultOutcome& run) {
  return fmt::format("{} {} {} {} {:d} {} {} {} {} {} {}\n", row, seed, index, run.violations,
                     run.measured, run.worst, run.bound, run.settled, run.harder, run.deeper,
                     run.found);
}

}  // namespace

Result<FaultJournal> FaultJournal::open(const std::string& path, const std::string& judge) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) return cannot("open", path);
  FaultJournal journal(path, file);
  struct stat kind {};
  if (::fstat(file, &kind) != 0 || !S_ISREG(kind.st_mode)) {
    return Status::error(path + ": not a file");
  }
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    return Status::error(path + ": another run writes its results here");
  }
  const Status read = journal.read(judge);
  if (!read) return read;
  return journal;
}

FaultJournal::FaultJournal(FaultJournal&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      runs_(std::move(other.runs_)) {}

FaultJournal::~FaultJournal() {
  if (file_ >= 0) ::close(file_);
}

Status FaultJournal::read(const std::string& judge) {
  std::string text;
  char buffer[65536];
  for (;;) {
    const ssize_t n = ::read(file_, buffer, sizeof buffer);
    if (n < 0) return cannot("read", path_);
    if (n == 0) break;
    text.append(buffer, static_cast<std::size_t>(n));
  }
  const std::string first = kTitle + judge + "\n";
  const std::size_t end = text.find('\n');
  if (end == text.npos ? !first.starts_with(text) : !text.starts_with(first)) {
    const std::string whose = text.substr(0, end);
    return Status::error(fmt::format(
        "{}:1: {}; expected '{}{}': name another file, or remove this one", path_,
        whose.starts_with(kTitle) ? "'" + whose + "'" : "no results of handrail-lab faults", kTitle,
        judge));
  }
  const std::size_t whole = end == text.npos ? 0 : text.rfind('\n') + 1;
  if (::ftruncate(file_, static_cast<off_t>(whole)) != 0) return cannot("write", path_);
  if (whole == 0) return write(first);
  int number = 1;
  for (std::size_t at = end + 1; at < whole; at = text.find('\n', at) + 1) {
    ++number;
    if (!take(std::string_view(text).substr(at, text.find('\n', at) - at))) {
      return Status::error(fmt::format("{}:{}: no result of a run", path_, number));
    }
  }
  return Status::ok();
}

bool FaultJournal::take(std::string_view line) {
  bool good = true;
  const auto word = [&] {
    const std::string_view out = line.substr(0, line.find(' '));
    good &= out.size() < line.size();
    line.remove_prefix(std::min(out.size() + 1, line.size()));
    return out;
  };
  const auto number = [&](auto& out) {
    const std::string_view text = word();
    const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    good &= error == std::errc() && last == text.data() + text.size();
  };
  const std::string row(word());
  std::uint64_t seed = 0;
  int index = 0, measured = 0;
  FaultOutcome run;
  number(seed);
  number(index);
  number(run.violations);
  number(measured);
  for (double* value : {&run.worst, &run.bound, &run.settled, &run.harder, &run.deeper}) {
    number(*value);
  }
  run.measured = measured != 0;
  run.found = line;
  if (good) runs_[{row, seed, index}] = run;
  return good;
}

const FaultOutcome* FaultJournal::find(const std::string& row, std::uint64_t seed,
                                       int index) const {
  const auto run = runs_.find({row, seed, index});
  return run == runs_.end() ? nullptr : &run->second;
}

Status FaultJournal::append(const std::string& row, std::uint64_t seed, int index,
                            const FaultOutcome& run) {
  runs_[{row, seed, index}] = run;
  return write(line_of(row, seed, index, run));
}

Status FaultJournal::write(const std::string& line) {
  const ssize_t written = ::write(file_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size())) return Status::ok();
  if (written >= 0) errno = ENOSPC;
  return cannot("write", path_);
}

Result<std::string> program_hash() {
  constexpr const char* kSelf = "/proc/self/exe";
  std::ifstream program(kSelf, std::ios::binary);
  std::ostringstream bytes;
  bytes << program.rdbuf();
  if (!program || !bytes) return Status::error(fmt::format("cannot read {}", kSelf));
  return fmt::format("program {:016x}", Fnv().text(bytes.str()).value());
}

}  // namespace handrail
