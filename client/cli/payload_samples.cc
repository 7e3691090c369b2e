#include "client/cli/payload_samples.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>

#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/scene/text_io.h"

namespace handrail {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::size_t kShort = 10, kLong = 12;
constexpr std::array<const char*, kLong> kColumns = {
    "qw",   "qx",     "qy",     "qz",     "fx_n",          "fy_n",
    "fz_n", "tx_n_m", "ty_n_m", "tz_n_m", "force_noise_n", "torque_noise_n_m"};
constexpr double kLargest = 1e6;

std::string header(std::size_t count) {
  std::string out = kColumns[0];
  for (std::size_t i = 1; i < count; ++i) out.append(",").append(kColumns[i]);
  return out;
}

struct Cell {
  std::string_view text;
  std::size_t column;
};

// At commas, without blanks around the cells.
std::vector<Cell> split(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t end = std::min(line.find(',', start), line.size());
    std::size_t first = start, last = end;
    while (first < last && line[first] == ' ') ++first;
    while (last > first && line[last - 1] == ' ') --last;
    cells.push_back({line.substr(first, last - first), first + 1});
    start = end + 1;
  }
  return cells;
}

// Reads line by line; the errors know where they are.
class Reader {
 public:
  explicit Reader(const std::string& place) : place_(place) {}

  Result<std::vector<PayloadSample>> read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      while (line.ends_with('\r') || line.ends_with(' ')) line.remove_suffix(1);
      if (line.empty()) continue;
      const Status status = columns_ == 0 ? take_header(line) : take_row(split(line));
      if (!status) return status;
    }
    if (columns_ != 0) return samples_;
    line_ = 1;
    return error(1, "the file is empty, expected the header " + header(kShort));
  }

 private:
  Status error(std::size_t column, const std::string& what) const {
    return Status::error(place_ + ":" + std::to_string(line_) + ":" + std::to_string(column) +
                         ": " + what);
  }

  Status take_header(std::string_view line) {
    const std::vector<Cell> cells = split(line);
    for (std::size_t i = 0; i < cells.size() && i < kLong; ++i) {
      if (cells[i].text == kColumns[i]) continue;
      return error(cells[i].column, "the header says '" + shown(cells[i].text) + "', expected " +
                                        kColumns[i] + " of " + header(kLong));
    }
    if (cells.size() != kShort && cells.size() != kLong) {
      return error(1, "the header has " + std::to_string(cells.size()) +
                          " columns, expected 10 or 12: " + header(kLong));
    }
    columns_ = cells.size();
    return Status::ok();
  }

  Status take_row(const std::vector<Cell>& cells) {
    if (cells.size() != columns_) {
      return error(1, std::to_string(cells.size()) + " values, expected " +
                          std::to_string(columns_) + " as in the header");
    }
    std::array<double, kLong> v{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::string_view text = cells[i].text;
      const char* const end = text.data() + text.size();
      const auto [stop, problem] = std::from_chars(text.data(), end, v[i]);
      const double least = i >= kShort ? 0.0 : -kLargest;
      if (problem == std::errc() && stop == end && v[i] >= least && v[i] <= kLargest) continue;
      return error(cells[i].column, std::string(kColumns[i]) + " is '" + shown(text) +
                                        "', expected a number from " +
                                        (i >= kShort ? "0" : "-1e6") + " to 1e6");
    }
    PayloadSample s;
    s.q_ST = Quat(v[0], v[1], v[2], v[3]);
    const double length = s.q_ST.norm();
    if (!(std::abs(length - 1.0) < 1e-2)) {
      char text[96];
      std::snprintf(text, sizeof text, "qw,qx,qy,qz has length %.3g, expected 1", length);
      return error(cells[0].column, text);
    }
    // Left as it is where only rounding is missing: a recording gives the same bits again.
    constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
    if (std::abs(length - 1.0) > kRounding) s.q_ST.normalize();
    s.raw_T = {{v[4], v[5], v[6]}, {v[7], v[8], v[9]}};
    s.force_noise = v[10];
    s.torque_noise = v[11];
    samples_.push_back(s);
    return Status::ok();
  }

  const std::string& place_;
  std::size_t line_ = 0;
  std::size_t columns_ = 0;
  std::vector<PayloadSample> samples_;
};

}  // namespace

Result<std::vector<PayloadSample>> parse_payload_samples(const std::string& place,
                                                         const std::string& text) {
  return Reader(place).read(text);
}

Result<std::vector<PayloadSample>> load_payload_samples(const std::string& path) {
  const Result<std::string> text = read_file(path, kMaxBytes);
  if (!text) return text.status();
  return parse_payload_samples(path, *text);
}

std::string payload_samples_text(const std::vector<PayloadSample>& samples) {
  std::string out = header(kLong) + '\n';
  for (const PayloadSample& s : samples) {
    const Quat& q = s.q_ST;
    const Vec3 &f = s.raw_T.force, &t = s.raw_T.torque;
    const double cells[kLong] = {q.w(), q.x(), q.y(), q.z(), f.x(),         f.y(),
                                 f.z(), t.x(), t.y(), t.z(), s.force_noise, s.torque_noise};
    for (std::size_t i = 0; i < kLong; ++i)
      out += number_text(cells[i]) + (i + 1 < kLong ? ',' : '\n');
  }
  return out;
}

}  // namespace handrail
