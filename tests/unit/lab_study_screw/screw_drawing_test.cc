#include "server/lab/study/screw/screw_drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "server/base/random.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/lab_study_screw/screw_samples.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

HexSocketSpec socket() {
  HexSocketSpec out;
  out.X_SK.p = Vec3(0.35, 0.0, 0.26);
  return out;
}

// Down into the socket, half a turn under load, up again; every 8 s.
std::vector<ScrewTracePoint> trace_of(ScrewMode mode) {
  std::vector<ScrewTracePoint> out;
  Random random(static_cast<std::uint64_t>(mode) + 1);
  const double load = has_protection(mode) ? 25.0 : 50.0;
  for (double t = 0.0; t < 32.0; t += 7.1e-3) {
    const double at = std::fmod(t, 8.0);
    const bool inside = at > 2.0 && at < 5.0;
    const double height = at <= 2.0 ? 12.0 - 8.0 * at
                          : inside  ? -4.0
                                    : -4.0 + 16.0 * (at - 5.0) / 3;
    const double aside = inside ? 0.1 : (has_tools(mode) ? 0.2 : 2.0);
    ScrewTracePoint point;
    point.time = 1.5 + t;
    point.p_ST =
        socket().X_SK.p + kMm * Vec3(aside * std::sin(3.0 * t), aside * std::cos(t), height);
    if (inside) point.contact = Vec3(3.0, 0.0, load * (1.0 + 0.1 * random.normal()));
    if (inside && has_protection(mode)) point.spring = Vec3(0.0, 0.0, 0.4);
    out.push_back(point);
  }
  return out;
}

ScrewStudy traced() {
  ScrewStudy out = five_people();
  for (int i = 0; i < kScrewModes; ++i) {
    out.trials[static_cast<std::size_t>(i)].result.trace = trace_of(static_cast<ScrewMode>(i));
  }
  return out;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(ScrewDrawing, WritesAllThreeFigures) {
  const TempFolder folder;
  const StudyHeader header = {"the-scene", "the-people", 5, 5, 1};
  const Status status = draw_screw(folder.path(), header, traced(), socket());
  ASSERT_TRUE(status) << status.message();
  const std::string measures = text_of(folder.path() + "/screw-fastening-measures.svg");
  const std::string paths = text_of(folder.path() + "/screw-fastening-trajectories.svg");
  const std::string forces = text_of(folder.path() + "/screw-fastening-forces.svg");
  for (const char* part : {"<svg", "Simulated operators (5, seed 5)", "NC-NV", "C-V", "implied",
                           "42.1", "153", "26.7"}) {
    EXPECT_THAT(measures, HasSubstr(part));
  }
  for (const char* part : {"Simulated operators", "NC-NV", "NC-V", "C-NV", "C-V", "socket"}) {
    EXPECT_THAT(paths, HasSubstr(part));
  }
  for (const char* part : {"Simulated operators", "with tools", "without tools", "virtual spring",
                           "contact", "time [s]"}) {
    EXPECT_THAT(forces, HasSubstr(part));
  }
}

TEST(ScrewDrawing, AModeWithoutASuccessfulTraceIsLeftOut) {
  const TempFolder folder;
  ScrewStudy study = traced();
  study.trials[0].result.end = ScrewEnd::kForce;
  ASSERT_TRUE(draw_screw(folder.path(), StudyHeader(), study, socket()));
  const std::string paths = text_of(folder.path() + "/screw-fastening-trajectories.svg");
  EXPECT_THAT(paths, Not(HasSubstr("NC-NV:")));
  EXPECT_THAT(paths, HasSubstr("C-V:"));
}

TEST(ScrewDrawing, NamesTheFolderItCannotWriteTo) {
  EXPECT_THAT(draw_screw("/proc/no", StudyHeader(), traced(), socket()).message(),
              HasSubstr("/proc/no"));
}

}  // namespace
}  // namespace handrail
