#include "tests/faults/kept.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

namespace handrail::faults {
namespace {

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

Status KeptResults::add(const std::string& row, std::uint64_t seed, const RowResult& result) const {
  if (commit_.empty()) return Status::ok();
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const std::string path = fmt::format("{}/{}{}-{}", folder_, start(row), seed, commit_);
  std::ofstream file(path);
  file << for_people(row, result, 0.0) << "\n" << std::flush;
  return file ? Status::ok() : Status::error(path + ": cannot be written");
}

std::optional<std::uint64_t> KeptResults::passed(const std::string& row,
                                                 std::optional<std::uint64_t> seed) const {
  std::error_code error;
  if (commit_.empty()) return std::nullopt;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string(), before = start(row);
    if (!name.starts_with(before) || !name.ends_with("-" + commit_)) continue;
    std::uint64_t of = 0;
    (void)std::from_chars(name.data() + before.size(), name.data() + name.size(), of);
    std::string line;
    std::ifstream file(entry.path());
    std::getline(file, line);
    const bool good = line.starts_with(fmt::format("{:4} {} ", row, name_of(Outcome::kPassed)));
    if (good && (!seed || *seed == of)) return of;
  }
  return std::nullopt;
}

std::string KeptResults::room(const std::string& row, std::uint64_t seed) const {
  return fmt::format("{}/kept/{}{}", folder_, start(row), seed);
}

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed: return "PASS";
    case Outcome::kFailed: return "FAIL";
    case Outcome::kSkipped: return "SKIPPED";
    case Outcome::kStopped: return "STOPPED";
  }
  return "?";
}

std::string for_people(const std::string& row, const RowResult& r, double seconds) {
  return one_line(fmt::format("{:4} {} {:3.0f} s  {}  MEASURED {}  ASKED {}{}{}", row,
                              name_of(r.outcome), seconds, r.done, r.measured, r.asked,
                              r.why.empty() ? "" : "  WHY ", r.why));
}

std::string to_json(const std::string& row, std::uint64_t seed, bool full, const RowResult& r,
                    double seconds) {
  return fmt::format(
      R"({{"row":{},"form":"{}","seed":{},"outcome":"{}","seconds":{:.1f},"done":{},"measured":{},"asked":{},"why":{}}})",
      quoted(row), full ? "full" : "quick", seed, name_of(r.outcome), seconds, quoted(r.done),
      quoted(r.measured), quoted(r.asked), quoted(r.why));
}

}  // namespace handrail::faults
