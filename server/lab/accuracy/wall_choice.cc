#include "server/lab/accuracy/wall_choice.h"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <memory>

#include "server/base/units.h"
#include "server/haptic/wall_proxies.h"
#include "server/lab/accuracy/wall_course.h"
#include "server/lab/scenes/contest.h"

namespace handrail {
namespace {

constexpr int kTurns = 40;
constexpr int kBatches = 128;
constexpr int kWallCalls = 8;
constexpr int kSettle = 20;          // ticks from free space to the course
constexpr double kBehind = 0.05e-3;  // a proxy this far from the exact one is said to be behind [m]

// One setting on its way along the courses.
struct WallRunner {
  Walls walls;
  std::unique_ptr<WallProxy> proxy;
  std::size_t course = 0;
  double way = 0.0;

  void set_out(std::size_t on) {
    course = on % wall_courses().size();
    const WallCourse& c = wall_courses()[course];
    proxy->start(c.free_at(0.0));
    for (int i = 1; i <= kSettle; ++i) {
      const double share = static_cast<double>(i) / kSettle;
      proxy->advance((1.0 - share) * c.free_at(0.0) + share * c.hand(0.0));
    }
    way = 0.0;
  }
  WallContact tick() {
    way += kCourseStep;
    return proxy->advance(wall_courses()[course].hand(way));
  }
};

struct Errors {
  ErrorSum surface;  // of the proxy, off the true wall [m]
  ErrorSum proxy;    // from the exact proxy [m]
};

Errors errors_of(WallRunner& runner) {
  Errors sum;
  for (std::size_t k = 0; k < wall_courses().size(); ++k) {
    runner.set_out(k);
    const WallCourse& course = wall_courses()[k];
    while (runner.way < 2.0 * course.length) {
      const Vec2 proxy = runner.tick().proxy;
      sum.surface.add(course.off_surface(proxy));
      sum.proxy.add((proxy - course.foot(runner.way)).norm());
    }
  }
  return sum;
}

std::size_t map_bytes(const Walls& walls) {
  if (!walls.map) return 0;
  const CoverageMap& m = *walls.map;
  return m.open.size() * sizeof(m.open[0]) + m.region.size() + m.wall.size();
}

}  // namespace

std::vector<WallSetting> wall_settings() {
  std::vector<WallSetting> out;
  for (const double pixel : {0.4, 0.2, 0.1, 0.05, 0.025}) {
    for (const double radius : {1.5, 2.5, 4.0}) {
      out.push_back({WallMethod::kPublished, pixel * kMm, radius});
    }
    out.push_back({WallMethod::kSubpixel, pixel * kMm, 0.0});
  }
  out.push_back({WallMethod::kExact, 0.0, 0.0});
  return out;
}

const char* name_of(WallMethod method) noexcept {
  switch (method) {
    case WallMethod::kPublished: return "published";
    case WallMethod::kSubpixel: return "subpixel";
    case WallMethod::kExact: break;
  }
  return "exact";
}

std::string describe(const WallSetting& s) {
  if (s.method == WallMethod::kExact) return "shapes";
  std::string pixel = fmt::format("pixel {:g} mm", s.pixel / kMm);
  if (s.method == WallMethod::kSubpixel) return pixel;
  return pixel + fmt::format(", radius {:g} px", s.radius);
}

AccuracyRows wall_rows(const std::vector<WallSetting>& settings,
                       const std::atomic<bool>& cancelled) {
  std::map<double, Walls> paintings;
  std::vector<std::unique_ptr<WallRunner>> runners;
  AccuracyRows rows;
  Contest contest;
  for (const WallSetting& setting : settings) {
    if (cancelled) return {};
    auto runner = std::make_unique<WallRunner>();
    if (setting.method == WallMethod::kExact) {
      runner->walls = course_shapes();
    } else {
      auto [at, fresh] = paintings.try_emplace(setting.pixel);
      if (fresh) at->second = course_painting(setting.pixel);
      runner->walls = at->second;
      runner->walls.method = setting.method;
      runner->walls.search_radius = setting.radius;
    }
    runner->proxy = make_wall_proxy(runner->walls);
    AccuracyRow row;
    row.choice = "wall";
    row.method = name_of(setting.method);
    row.setting = describe(setting);
    if (setting.method == WallMethod::kExact) row.needs = "drawn walls";
    const Errors errors = errors_of(*runner);
    row.error = errors.surface.in("um", 1e6);
    row.whole = errors.proxy.in("um", 1e6);
    if (errors.proxy.worst() > kBehind) {
      row.note = fmt::format("stays up to {:.2f} mm behind", errors.proxy.worst() / kMm);
    }
    row.memory_bytes = runner->proxy->memory() + map_bytes(runner->walls);
    rows.push_back(row);
    contest.add([r = runner.get()] { r->set_out(r->course + 1); },
                [r = runner.get()] {
                  for (int i = 0; i < kWallCalls; ++i) keep(r->tick());
                },
                kWallCalls);
    runners.push_back(std::move(runner));
  }
  contest.run(kTurns, kBatches, cancelled);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Contest::Time time = contest.time(i);
    rows[i].cost = {"ns", time.median, time.p999};
  }
  return rows;
}

}  // namespace handrail
