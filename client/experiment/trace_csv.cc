#include "client/experiment/trace_csv.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "server/base/plain_text.h"
#include "server/base/units.h"

namespace handrail {
namespace {

constexpr char kHead[] =
    "time_s,phase,tip_x_mm,tip_y_mm,tip_z_mm,tip_qw,tip_qx,tip_qy,tip_qz,"
    "command_x_mm,command_y_mm,command_z_mm,hand_x_mm,hand_y_mm,hand_z_mm,"
    "force_x_n,force_y_n,force_z_n\n";
constexpr const char* kPhaseNames[kLinearPhases] = {"AB", "turn", "BC"};

std::string three(const Vec3& v, double unit) {
  return fmt::format("{:.5f},{:.5f},{:.5f}", v.x() / unit, v.y() / unit, v.z() / unit);
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) out.push_back(field);
  return out;
}

std::optional<double> number_in(const std::string& text) {
  double out = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(out)) return {};
  return out;
}

}  // namespace

std::string trace_file(const std::string& folder, const std::string& experiment,
                       const std::string& subject, int trial) {
  return fmt::format("{}/{}.{}.{:02}.csv", folder, experiment, subject, trial);
}

Status write_trace(const std::string& file, const std::vector<TraceRow>& rows) {
  if (rows.empty()) return Status::ok();
  std::ofstream out(file);
  out << kHead;
  for (const TraceRow& row : rows) {
    const Quat& q = row.X_ST.q;
    out << fmt::format("{:.4f},{},{},{:.7f},{:.7f},{:.7f},{:.7f},{},{},{}\n",
                       row.time - rows.front().time, kPhaseNames[static_cast<int>(row.phase)],
                       three(row.X_ST.p, kMm), q.w(), q.x(), q.y(), q.z(), three(row.X_SU.p, kMm),
                       three(row.p_MH, kMm), three(row.f_H_M, 1.0));
  }
  out.close();
  if (out) return Status::ok();
  return Status::error(shown(file, 200) + ": cannot be written: " + std::strerror(errno));
}

Result<std::vector<std::vector<double>>> read_trace(const std::string& file,
                                                    const std::vector<std::string>& columns) {
  std::ifstream in(file);
  if (!in) return Status::error(shown(file, 200) + ": cannot be read: " + std::strerror(errno));
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> head = fields_of(line);
  std::vector<std::size_t> places;
  for (const std::string& column : columns) {
    const auto place = std::find(head.begin(), head.end(), column);
    if (place == head.end()) {
      return Status::error(shown(file, 200) + ": line 1: no column '" + column + "'");
    }
    places.push_back(static_cast<std::size_t>(place - head.begin()));
  }
  std::vector<std::vector<double>> out;
  for (int number = 2; std::getline(in, line) && !in.eof(); ++number) {
    const std::vector<std::string> fields = fields_of(line);
    std::vector<double>& row = out.emplace_back();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string text = places[i] < fields.size() ? fields[places[i]] : "";
      const std::optional<double> value = number_in(text);
      if (!value) {
        return Status::error(fmt::format("{}: line {}: {} is '{}', expected a number",
                                         shown(file, 200), number, columns[i], shown(text)));
      }
      row.push_back(*value);
    }
  }
  return out;
}

}  // namespace handrail
