#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "server/base/units.h"
#include "server/constraint/position_tool.h"
#include "server/lab/accuracy/choices.h"
#include "server/lab/scenes/contest.h"

namespace handrail {
namespace {

constexpr int kTicks = 4096;
constexpr int kToolCalls = 8;

// A line and a plane across the axes, both ways.
std::array<ToolDefinition, 2> tools() {
  std::array<ToolDefinition, 2> out;
  out[0].kind = ToolKind::kLine;
  out[0].direction_S = Vec3(3.0, -2.0, 1.0).normalized();
  out[1].kind = ToolKind::kPlane;
  out[1].normal_S = Vec3(1.0, 2.0, 5.0).normalized();
  return out;
}

// A closed way within 60 mm, at most 0.25 m/s at 1 kHz [m].
Vec3 hand_at(int tick) {
  const double turn = 2.0 * 3.14159265358979 * tick / kTicks;
  return {0.060 * std::sin(2.0 * turn), 0.040 * std::sin(3.0 * turn + 1.0),
          0.030 * std::cos(4.0 * turn)};
}

struct Runner {
  std::array<PositionTool, 2> tool;
  std::array<PositionTool, 2> reference;
  int tick = 0;

  Runner(GuidanceMethod method, double delta) {
    for (std::size_t i = 0; i < tool.size(); ++i) {
      tool[i] = PositionTool(tools()[i], method, delta);
      reference[i] = PositionTool(tools()[i], GuidanceMethod::kExact, delta);
      tool[i].start(hand_at(0), hand_at(0));
      reference[i].start(hand_at(0), hand_at(0));
    }
  }
  ErrorSum error() {
    ErrorSum sum;
    for (int i = 1; i <= kTicks; ++i) {
      for (std::size_t k = 0; k < tool.size(); ++k) {
        sum.add((tool[k].advance(hand_at(i)) - reference[k].advance(hand_at(i))).norm());
      }
    }
    return sum;
  }
};

}  // namespace

AccuracyRows tool_rows(const std::atomic<bool>& cancelled) {
  std::vector<Vec3> hands;
  for (int i = 0; i < kTicks; ++i) hands.push_back(hand_at(i));
  AccuracyRows rows;
  std::vector<std::unique_ptr<Runner>> runners;
  Contest contest;
  const auto enter = [&](GuidanceMethod method, double delta, const std::string& setting) {
    auto runner = std::make_unique<Runner>(method, delta);
    AccuracyRow row;
    row.choice = "tool_step";
    row.method = method == GuidanceMethod::kExact ? "exact" : "published";
    row.setting = setting;
    row.error = runner->error().in("um", 1e6);
    if (method == GuidanceMethod::kPublished && row.error.worst > 2.0 * delta * 1e6) {
      row.note = "too few steps in a tick to keep up with the hand";
    }
    row.memory_bytes = sizeof(PositionTool);
    rows.push_back(row);
    contest.add([] {},
                [r = runner.get(), &hands] {
                  for (int i = 0; i < kToolCalls; ++i) {
                    r->tick = (r->tick + 1) % kTicks;
                    keep(r->tool[0].advance(hands[static_cast<std::size_t>(r->tick)]));
                  }
                },
                kToolCalls);
    runners.push_back(std::move(runner));
  };
  for (const double mm : {1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001}) {
    enter(GuidanceMethod::kPublished, mm * kMm, fmt::format("delta {:g} mm", mm));
  }
  enter(GuidanceMethod::kExact, 1e-4, "closed form");
  contest.run(20, 256, cancelled);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cost = {"ns", contest.time(i).median, contest.time(i).p999};
  }
  return rows;
}

}  // namespace handrail
