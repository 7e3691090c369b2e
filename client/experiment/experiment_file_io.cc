#include "client/experiment/experiment_file_io.h"

#include <fcntl.h>
#include <google/protobuf/util/json_util.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20U;  // a trial's two lines take 700

Status failure(const std::string& file, const char* what) {
  return Status::error(fmt::format("{}: {}: {}", shown(file, 200), what, std::strerror(errno)));
}

// A line's part of the record; empty: it is in order.
std::string take(const pb::ExperimentLine& line, bool first, ExperimentRecord& out) {
  if (first != line.has_subject()) {
    return first ? "expected the subject in the first line" : "a second subject";
  }
  const bool runs = !out.trials.empty() && out.trials.back().interrupted();
  switch (line.line_case()) {
    case pb::ExperimentLine::kSubject: out.subject = line.subject(); return {};
    case pb::ExperimentLine::kBegan:
      out.trials.push_back(line.began());
      out.trials.back().set_interrupted(true);  // until its end is read
      return {};
    case pb::ExperimentLine::kEnded:
      if (!runs) return "a trial ends that did not begin";
      out.trials.back() = line.ended();
      return {};
    case pb::ExperimentLine::kAnswers: out.answers = line.answers(); return {};
    case pb::ExperimentLine::LINE_NOT_SET: break;
  }
  return "expected subject, began, ended or answers";
}

}  // namespace

std::string experiment_file(const std::string& folder, const std::string& experiment,
                            const std::string& subject) {
  return folder + "/" + experiment + "." + subject + kExperimentExtension;
}

std::string line_of(const pb::ExperimentLine& line) {
  return json_of_set_fields(line, false) + '\n';
}

Result<ExperimentRecord> parse_experiment(const std::string& file, const std::string& text) {
  ExperimentRecord out;
  for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) {
      out.cut = true;
      break;
    }
    pb::ExperimentLine line;
    const auto read = google::protobuf::util::JsonStringToMessage(text.substr(at, end - at), &line);
    std::string problem =
        read.ok() ? std::string() : "no such line: " + std::string(read.message());
    if (problem.empty()) problem = take(line, number == 1, out);
    if (!problem.empty()) {
      return Status::error(fmt::format("{}:{}: {}", shown(file, 200), number, shown(problem, 160)));
    }
    out.whole = at = end + 1;
  }
  return out;
}

Result<ExperimentRecord> read_experiment(const std::string& file) {
  const Result<std::string> text = read_file(file, kMostBytes);
  if (!text) return text.status();
  return parse_experiment(file, *text);
}

ExperimentFile::~ExperimentFile() {
  if (fd_ >= 0) ::close(fd_);
}

Status ExperimentFile::open(const std::string& file, const pb::ExperimentSubject& subject,
                            bool resume, ExperimentRecord& out) {
  path_ = file;
  std::error_code made;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (std::filesystem::create_directories(folder, made); made) {
    return Status::error(shown(folder.string(), 200) + ": cannot be made: " + made.message());
  }
  fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) return failure(file, "cannot be written");
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    return Status::error(shown(file, 200) +
                         ": another `handrail experiment` has it open: end that one first");
  }
  const Result<ExperimentRecord> before = read_experiment(file);
  if (!before) return before.status();
  out = *before;
  if (out.cut && ::ftruncate(fd_, static_cast<off_t>(out.whole)) != 0)
    return failure(file, "the line that was cut off cannot be removed");
  if (!out.subject.has_subject()) {
    pb::ExperimentLine line;
    *line.mutable_subject() = out.subject = subject;
    return append(line);
  }
  if (!resume) {
    return Status::error(shown(file, 200) +
                         ": is there already: --resume goes on with it, another --subject begins");
  }
  const pb::ExperimentSubject& there = out.subject;
  if (there.experiment() != subject.experiment() || there.subject() != subject.subject() ||
      there.simulated() != subject.simulated()) {
    return Status::error(fmt::format(
        "{}: is of {} '{}' in {}, expected {} '{}' in {}: choose another --subject or --out",
        shown(file, 200), there.simulated() ? "the simulated" : "the person",
        shown(there.subject()), shown(there.experiment()),
        subject.simulated() ? "the simulated" : "the person", subject.subject(),
        subject.experiment()));
  }
  return Status::ok();
}

Status ExperimentFile::append(const pb::ExperimentLine& line) {
  const std::string text = line_of(line);
  const off_t before = ::lseek(fd_, 0, SEEK_END);
  std::size_t written = 0;
  while (before >= 0 && written < text.size()) {
    const ssize_t n = ::write(fd_, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    written += static_cast<std::size_t>(n);
  }
  if (written == text.size() && ::fdatasync(fd_) == 0) return Status::ok();
  Status failed = failure(path_, "cannot be written");
  // Nothing of a line, rather than half of it.
  if (before >= 0 && ::ftruncate(fd_, before) != 0) errno = 0;
  return failed;
}

}  // namespace handrail
