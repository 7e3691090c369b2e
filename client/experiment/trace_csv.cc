#include "client/experiment/trace_csv.h"

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstring>
#include <fstream>

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

}  // namespace handrail
