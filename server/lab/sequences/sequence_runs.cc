#include "server/lab/sequences/sequence_runs.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "server/base/output.h"
#include "server/base/read_file.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

// A second or so on two cores: what Ctrl-C loses, at most.
constexpr std::uint64_t kRound = 2000;
constexpr const char* kTitle = "handrail-lab tool-sequences, results of ";
constexpr std::size_t kLargestFile = 65536;  // ten times what one is

// The counts of a file, in order.
template <typename Figures>
auto counts_of(Figures& f) {
  return std::array{&f.sequences, &f.ticks, &f.led, &f.tools, &f.refused};
}

std::string line_of(const Worst& worst, std::uint64_t broken) {
  return fmt::format("{} {} {} {} {} {}\n", worst.judged.ratio, worst.judged.measured,
                     worst.judged.allowed, worst.seed, worst.tick, broken);
}

// A number as fmt prints it; streams do not read `inf`.
bool read_number(std::istream& in, double& out) {
  std::string word;
  in >> word;
  char* end = nullptr;
  out = std::strtod(word.c_str(), &end);
  return !word.empty() && *end == '\0';
}

bool read_line(std::istream& in, Worst& worst, std::uint64_t& broken) {
  Judged& j = worst.judged;
  return read_number(in, j.ratio) && read_number(in, j.measured) && read_number(in, j.allowed) &&
         static_cast<bool>(in >> worst.seed >> worst.tick >> broken);
}

double share(std::uint64_t part, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
}

}  // namespace

Result<bool> run_sequences(SequenceRun& run, std::uint64_t of, int threads,
                           const std::atomic<bool>& cancelled,
                           const std::function<Status(const SequenceRun&)>& round) {
  while (run.figures.sequences < of) {
    const std::uint64_t done = run.figures.sequences;
    std::vector<SequenceFigures> figures(std::min(kRound, of - done));
    const auto job = [&](std::size_t i) { figures[i] = run_sequence(run.first + done + i); };
    if (!run_parallel(figures.size(), threads, job, {}, &cancelled)) return false;
    for (const SequenceFigures& one : figures) run.figures.add(one);
    if (const Status s = round(run); !s) return s;
  }
  return true;
}

Status save_run(const std::string& path, const std::string& judge, const SequenceRun& run) {
  const SequenceFigures& f = run.figures;
  std::string out = fmt::format("{}{}\n{}", kTitle, judge, run.first);
  for (const std::uint64_t* count : counts_of(f)) out += fmt::format(" {}", *count);
  out += "\n";
  for (std::size_t i = 0; i < kBounds; ++i) out += line_of(f.worst[i], f.broken[i]);
  return write_file(path, out);
}

Result<SequenceRun> load_run(const std::string& path, const std::string& judge) {
  const auto text = read_file(path, kLargestFile);
  if (!text) return text.status();
  std::istringstream in(text.value());
  const std::string expected = kTitle + judge;
  std::string title;
  std::getline(in, title);
  if (title != expected) {
    return Status::error(fmt::format(
        "{}:1: {}; expected '{}': name another file, or remove this "
        "one",
        path,
        title.starts_with(kTitle) ? "'" + title + "'" : "no results of handrail-lab tool-sequences",
        expected));
  }
  SequenceRun run;
  SequenceFigures& f = run.figures;
  in >> run.first;
  for (std::uint64_t* count : counts_of(f)) in >> *count;
  bool good = static_cast<bool>(in);
  for (std::size_t i = 0; i < kBounds; ++i) good = good && read_line(in, f.worst[i], f.broken[i]);
  std::string more;
  if (!good || in >> more) {
    return Status::error(fmt::format(
        "{}: not whole, or not as it was written; expected {} lines of numbers after the first",
        path, kBounds + 1));
  }
  return run;
}

std::string sequence_table(const SequenceRun& run) {
  const SequenceFigures& f = run.figures;
  std::string out = fmt::format("  {:<26}{:>14}{:>14}{:>14} {:<5}{:>22}{:>7}{:>10}\n", "bound",
                                "worst share", "measured", "allowed", "", "seed", "tick", "broken");
  for (std::size_t i = 0; i < kBounds; ++i) {
    const Worst& w = f.worst[i];
    out +=
        fmt::format("  {:<26}{:>14.9f}{:>14.6g}{:>14.6g} {:<5}{:>22}{:>7}{:>10}\n",
                    name_of(static_cast<Bound>(i)), w.judged.ratio, w.judged.measured,
                    w.judged.allowed, unit_of(static_cast<Bound>(i)), w.seed, w.tick, f.broken[i]);
  }
  out += fmt::format(
      "  {} sequences of {} ticks from seed {} on, the arm led in {:.1f} % of them; {} tools "
      "called, {} orders refused\n",
      f.sequences, kSequenceTicks, run.first, 100.0 * share(f.led, f.ticks), f.tools, f.refused);
  return out;
}

std::string sequence_json(const SequenceRun& run) {
  const SequenceFigures& f = run.figures;
  std::string out = fmt::format(
      "{{\"seed\": {}, \"sequences\": {}, \"ticks\": {}, \"led\": {}, \"tools\": {}, \"refused\": "
      "{}, \"bounds\": [",
      run.first, f.sequences, f.ticks, f.led, f.tools, f.refused);
  for (std::size_t i = 0; i < kBounds; ++i) {
    const Worst& w = f.worst[i];
    // JSON has no infinity: of what must be nothing there is no share.
    const std::string ratio =
        std::isfinite(w.judged.ratio) ? fmt::format("{}", w.judged.ratio) : std::string("null");
    out += fmt::format(
        "{}\n  {{\"bound\": \"{}\", \"unit\": \"{}\", \"ratio\": {}, \"measured\": {}, "
        "\"allowed\": {}, \"seed\": {}, \"tick\": {}, \"broken\": {}}}",
        i == 0 ? "" : ",", name_of(static_cast<Bound>(i)), unit_of(static_cast<Bound>(i)), ratio,
        w.judged.measured, w.judged.allowed, w.seed, w.tick, f.broken[i]);
  }
  return out + "\n]}\n";
}

}  // namespace handrail
