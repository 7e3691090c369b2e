#include "tests/storm/results.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

namespace handrail::storm {
namespace {

constexpr std::size_t kColumns = 14;

std::string on_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\t', ' ');
  return text;
}

template <typename Number>
bool read(const std::string& text, Number& out) {
  std::istringstream in(text);
  return static_cast<bool>(in >> out) && in.peek() == std::istringstream::traits_type::eof();
}

}  // namespace

Line line_of(const Sequence& sequence, const Outcome& outcome) {
  Line out;
  out.seed = sequence.seed;
  out.ok = outcome.violations.empty();
  out.seconds = outcome.seconds;
  out.figures = outcome.figures;
  out.done = text(sequence);
  for (const Violation& v : outcome.violations) {
    out.violated += fmt::format("{}{:.3f} s: {}", out.violated.empty() ? "" : " | ",
                                to_seconds(v.at - outcome.start), v.what);
  }
  return out;
}

std::string to_line(const Line& r) {
  const Figures& f = r.figures;
  return fmt::format("{}\t{}\t{:.1f}\t{}\t{}\t{:.2f}\t{:.2f}\t{:.2f}\t{}\t{}\t{}\t{:.2f}\t{}\t{}",
                     r.seed, r.ok ? "ok" : "VIOLATED", r.seconds, f.targets, f.breaches, f.step,
                     f.acceleration, f.jerk, f.held, f.late, f.halts, f.hardest_halt,
                     on_one_line(r.done), on_one_line(r.violated));
}

Result<Line> from_line(const std::string& line) {
  std::vector<std::string> column;
  std::istringstream in(line);
  for (std::string text; std::getline(in, text, '\t');) column.push_back(text);
  if (line.ends_with('\t')) column.emplace_back();
  if (column.size() != kColumns) {
    return Status::error(fmt::format("{} columns, expected {}", column.size(), kColumns));
  }
  Line r;
  Figures& f = r.figures;
  r.ok = column[1] == "ok";
  r.done = column[12];
  r.violated = column[13];
  const bool read_all =
      read(column[0], r.seed) && read(column[2], r.seconds) && read(column[3], f.targets) &&
      read(column[4], f.breaches) && read(column[5], f.step) && read(column[6], f.acceleration) &&
      read(column[7], f.jerk) && read(column[8], f.held) && read(column[9], f.late) &&
      read(column[10], f.halts) && read(column[11], f.hardest_halt);
  if (!read_all || (!r.ok && column[1] != "VIOLATED")) {
    return Status::error(fmt::format("'{}...', expected a line of results", line.substr(0, 40)));
  }
  return r;
}

std::string for_people(const Line& r) {
  const Figures& f = r.figures;
  return fmt::format(
      "{}: {} in {:.1f} s; step {:.2f}, acceleration {:.2f}, jerk {:.2f} of the limits; {} cycles "
      "held, {} by late commands, {} halts up to {:.1f}; {}{}{}\n",
      r.seed, r.ok ? "ok" : "VIOLATED", r.seconds, f.step, f.acceleration, f.jerk, f.held, f.late,
      f.halts, f.hardest_halt, r.done, r.ok ? "" : "\n    ", r.violated);
}

void Summary::add(const Line& line) {
  ++ran;
  if (!line.ok) red.push_back(line.seed);
  figures.add(line.figures);
}

double Summary::bound() const {
  return ran == 0 ? 1.0 : std::min(1.0, 3.0 / static_cast<double>(ran));
}

std::string for_people(const Summary& all) {
  const Figures& f = all.figures;
  std::string out = fmt::format(
      "storm: {} of {} sequences violated; of {} targets {} beyond a limit, up to {:.2f} of a "
      "step, {:.2f} of acceleration, {:.2f} of jerk; {} cycles held in motion, {} more by late "
      "commands, {} halts up to {:.1f} of acceleration\n",
      all.red.size(), all.ran, f.targets, f.breaches, f.step, f.acceleration, f.jerk, f.held,
      f.late, f.halts, f.hardest_halt);
  if (all.red.empty()) {
    out += fmt::format("storm: with 95 % confidence fewer than {:.1f} % of such sequences are\n",
                       100.0 * all.bound());
  } else {
    out += fmt::format("storm: violated at seeds {}\n", fmt::join(all.red, ", "));
  }
  return out;
}

std::string to_json(const Summary& all) {
  const Figures& f = all.figures;
  return fmt::format(
      "{{\"sequences\": {}, \"violated\": {}, \"seeds_with_violations\": [{}], \"targets\": {}, "
      "\"beyond_a_limit\": {}, \"step\": {:.6g}, \"acceleration\": {:.6g}, \"jerk\": {:.6g}, "
      "\"held_cycles\": {}, \"late_cycles\": {}, \"halts\": {}, \"hardest_halt\": {:.6g}}}\n",
      all.ran, all.red.size(), fmt::join(all.red, ", "), f.targets, f.breaches, f.step,
      f.acceleration, f.jerk, f.held, f.late, f.halts, f.hardest_halt);
}

Status Results::open(const std::string& path) {
  path_ = path;
  if (path.empty()) return Status::ok();
  std::ifstream in(path, std::ios::binary);
  std::uintmax_t whole = 0;
  std::string line;
  for (int number = 1; std::getline(in, line) && !in.eof(); ++number) {
    const auto read = from_line(line);
    if (!read) return Status::error(fmt::format("{}:{}: {}", path, number, read.message()));
    known_.insert_or_assign(read->seed, *read);
    whole += line.size() + 1;
  }
  if (in.is_open()) {
    in.close();
    std::error_code error;
    std::filesystem::resize_file(path, whole, error);
    if (error) return Status::error(path + ": " + error.message());
  }
  file_.open(path, std::ios::binary | std::ios::app);
  return file_ ? Status::ok() : Status::error(path + ": " + std::strerror(errno));
}

Status Results::add(const Line& line) {
  known_.insert_or_assign(line.seed, line);
  if (path_.empty()) return Status::ok();
  file_ << to_line(line) << '\n' << std::flush;
  return file_ ? Status::ok() : Status::error(path_ + ": " + std::strerror(errno));
}

}  // namespace handrail::storm
