#include "devices/hand/recorded_hand_io.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/units.h"

namespace handrail {
namespace {

constexpr std::size_t kMaxColumns = 4;
constexpr std::array<const char*, kMaxColumns> kColumns = {"t_s", "x_mm", "y_mm", "z_mm"};
constexpr std::streamsize kLongestLine = 1000;  // characters
constexpr double kShortestSpacing = 1e-6;       // [s]; half of it is left to rounding
constexpr double kLatestTime = 4e9;             // [s]
// A recorder that misses so much has stopped; what is between is simulated at 1 kHz [s].
constexpr double kLongestGap = 60.0;
constexpr double kFarthest_mm = 1e5;

using Line = std::array<char, kLongestLine + 1>;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string quoted(std::string_view text) { return '"' + shown(text, 40) + '"'; }

// Splits at commas into at most `cells.size()` cells; returns how many there are in all.
std::size_t split(std::string_view line, std::array<std::string_view, kMaxColumns>& cells) {
  std::size_t count = 0;
  while (true) {
    const auto comma = line.find(',');
    if (count < cells.size()) cells[count] = trimmed(line.substr(0, comma));
    ++count;
    if (comma == std::string_view::npos) return count;
    line.remove_prefix(comma + 1);
  }
}

// A finite number that fills the whole cell.
std::optional<double> number(std::string_view cell) {
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return {};
  return value;
}

std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

// One pass over the stream, a line at a time.
class Reader {
 public:
  Reader(std::istream& in, const std::string& name) : in_(in), name_(name) {}

  Result<RecordedMotion> read() {
    if (Status status = header(); !status) return status;
    std::size_t empty_line = 0;
    std::string_view line;
    while (next(line)) {
      if (trimmed(line).empty()) {
        if (empty_line == 0) empty_line = line_;
        continue;
      }
      if (empty_line != 0) {
        line_ = empty_line;
        return error("the line is empty, expected " + std::to_string(columns_) + " numbers");
      }
      if (Status status = row(line); !status) return status;
    }
    if (!failure_.is_ok()) return failure_;
    if (samples_.size() < 2) {
      return error("the file ends after " + std::to_string(samples_.size()) +
                   " rows of numbers, expected at least 2");
    }
    return RecordedMotion(std::move(samples_));
  }

 private:
  Status error(const std::string& what) const {
    return Status::error(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  // The next line without its end, or false at the end of the file and on failure.
  bool next(std::string_view& line) {
    in_.getline(buffer_.data(), kLongestLine + 1);
    const auto count = in_.gcount();
    if (in_.bad()) {
      failure_ = Status::error(name_ + ": cannot be read, expected a CSV file");
      return false;
    }
    if (count == 0 && in_.eof()) return false;
    ++line_;
    if (in_.fail()) {
      failure_ = error("the line is longer than " + std::to_string(kLongestLine - 1) +
                       " characters, expected a line of a CSV file");
      return false;
    }
    line = std::string_view(buffer_.data(), static_cast<std::size_t>(count) - (in_.eof() ? 0 : 1));
    return true;
  }

  Status header() {
    std::string_view line;
    if (!next(line)) {
      if (!failure_.is_ok()) return failure_;
      line_ = 1;
      return error("the file is empty, expected the header t_s,x_mm,y_mm or t_s,x_mm,y_mm,z_mm");
    }
    if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    std::array<std::string_view, kMaxColumns> cells;
    columns_ = split(line, cells);
    bool right = columns_ == 3 || columns_ == 4;
    for (std::size_t i = 0; right && i < columns_; ++i) right = cells[i] == kColumns[i];
    if (right) return Status::ok();
    return error("the header is " + quoted(trimmed(line)) +
                 ", expected t_s,x_mm,y_mm or t_s,x_mm,y_mm,z_mm");
  }

  Status row(std::string_view line) {
    std::array<std::string_view, kMaxColumns> cells;
    const std::size_t count = split(line, cells);
    if (count != columns_) {
      return error("the row " + quoted(trimmed(line)) + " has " + std::to_string(count) +
                   " columns, expected " + std::to_string(columns_));
    }
    std::array<double, kMaxColumns> values{};
    for (std::size_t i = 0; i < count; ++i) {
      const double limit = i == 0 ? kLatestTime : kFarthest_mm;
      const std::optional<double> value = number(cells[i]);
      if (!value || std::abs(*value) > limit) {
        return error(std::string(kColumns[i]) + " is " + quoted(cells[i]) +
                     ", expected a number from " + text_of(-limit) + " to " + text_of(limit));
      }
      values[i] = *value;
    }
    const double t = values[0];
    if (!samples_.empty() && !(t - samples_.back().t >= kShortestSpacing * 0.5)) {
      return error("t_s is " + quoted(cells[0]) + ", expected at least 1 us more than the " +
                   text_of(samples_.back().t) + " of the row before");
    }
    if (!samples_.empty() && t - samples_.back().t > kLongestGap) {
      return error("t_s is " + quoted(cells[0]) + ", expected at most " + text_of(kLongestGap) +
                   " s more than the " + text_of(samples_.back().t) + " of the row before");
    }
    samples_.push_back({t, kMm * Vec3(values[1], values[2], values[3])});
    return Status::ok();
  }

  std::istream& in_;
  const std::string& name_;
  Line buffer_{};
  std::size_t line_ = 0;
  std::size_t columns_ = 0;
  Status failure_ = Status::ok();
  std::vector<RecordedSample> samples_;
};

}  // namespace

Result<RecordedMotion> load_recorded_motion(const std::string& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    return Status::error(path + ": cannot be opened (" + std::strerror(errno) +
                         "), expected a CSV file");
  }
  return read_recorded_motion(in, path);
}

Result<RecordedMotion> read_recorded_motion(std::istream& in, const std::string& name) {
  return Reader(in, name).read();
}

}  // namespace handrail
