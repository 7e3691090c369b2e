#include "tests/faults/faults_args.h"

#include <charconv>
#include <random>

#include "server/base/plain_text.h"

namespace handrail::faults {
namespace {

constexpr std::uint64_t kDrawn = 1'000'000;  // small enough to be typed

Status add_row(const std::string& word, FaultsArgs& out) {
  std::vector<std::string> names;
  for (const FaultRow& row : all_rows()) {
    names.emplace_back(row.id);
    if (word != row.id) continue;
    out.rows.push_back(&row);
    return Status::ok();
  }
  return Status::error(shown(word) + ": expected an option, or a row of " + joined(names, ", "));
}

Status read_seed(const std::string& text, FaultsArgs& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.seed);
  out.seeded = error == std::errc() && end == text.data() + text.size();
  if (out.seeded) return Status::ok();
  return Status::error("--seed '" + shown(text) + "': expected a whole number from 0 on");
}

}  // namespace

Result<FaultsArgs> read_faults_args(const std::vector<std::string>& words) {
  FaultsArgs out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--help" || word == "-h") {
      out.help = true;
    } else if (word == "--list") {
      out.list = true;
    } else if (word == "--quick" || word == "--full") {
      out.full = word == "--full";
    } else if (word == "--json") {
      out.json = true;
    } else if (word == "--resume") {
      out.resume = true;
    } else if (word == "--seed" || word == "--results") {
      if (i + 1 == words.size()) return Status::error(word + ": its value is missing");
      const std::string& value = words[++i];
      if (word == "--results") out.results = value;
      if (word == "--results") continue;
      if (Status read = read_seed(value, out); !read) return read;
    } else if (Status added = add_row(word, out); !added) {
      return added;
    }
  }
  if (out.rows.empty()) {
    for (const FaultRow& row : all_rows()) out.rows.push_back(&row);
  }
  if (!out.seeded) out.seed = std::random_device()() % kDrawn;
  return out;
}

std::string faults_usage() {
  return "usage: tests/faults/run [--quick|--full] [--seed N] [--resume] [--json] [--list] "
         "[ROW...]\n"
         "\n"
         "Rig and slave on one side of an emulated network, master on the other, an encrypted "
         "link\n"
         "between; what a row puts in, and what a judge makes of the rig's tap. A line a row. "
         "Exit\n"
         "codes: 0 nothing failed, 1 something did, 2 usage, 130 stopped.\n"
         "\n"
         "  --quick          all rows in ten minutes (the default)\n"
         "  --full           the levels and spans of the matrix\n"
         "  --seed N         drawn and printed when absent\n"
         "  --resume         without the rows that passed at this commit, in this form, at the "
         "seed\n"
         "                   if one is given\n"
         "  --results FOLDER where results are kept, build/faults; what a row that failed leaves "
         "is\n"
         "                   in kept/ there\n"
         "  --json           a line of JSON a row\n"
         "  --list           the rows\n";
}

}  // namespace handrail::faults
