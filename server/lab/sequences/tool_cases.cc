#include "server/lab/sequences/tool_cases.h"

#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "server/base/units.h"
#include "server/lab/sequences/case_rig.h"

namespace handrail {
namespace {

constexpr double kHalf = std::numbers::pi;
// Oblique to every axis of a tool, so that none is met by chance.
const Vec3 kAway = Vec3(0.36, -0.48, 0.8);
const Vec3 kAbout = Vec3(0.48, 0.6, -0.64);

struct CaseTool {
  const char* name;
  ToolCall call;
};

ToolCall tool_of(ToolKind kind) {
  ToolCall call;
  call.kind = kind;
  call.direction_S = Vec3(1.0, 2.0, -0.5);
  call.normal_S = Vec3(-0.2, 0.4, 1.0);
  return call;
}

// Each kind, with what it may have; "none" drops.
std::vector<CaseTool> named_tools() {
  ToolCall one_way = tool_of(ToolKind::kLine), ended = one_way, aisle = tool_of(ToolKind::kPlane);
  one_way.one_way = true;
  ended.has_end = true;
  aisle.one_way = true;
  ToolCall stiff = tool_of(ToolKind::kPoint);
  stiff.stiffness = 5000.0;
  return {{"none", {}},
          {"point", tool_of(ToolKind::kPoint)},
          {"stiff point", stiff},
          {"line", tool_of(ToolKind::kLine)},
          {"one-way line", one_way},
          {"line with an end", ended},
          {"plane", tool_of(ToolKind::kPlane)},
          {"one-way plane", aisle},
          {"n-rotation", tool_of(ToolKind::kNRotation)},
          {"f-rotation", tool_of(ToolKind::kFRotation)}};
}

void change_to(const CaseTool& tool, double away, bool approach, CaseRig& rig) {
  ToolCall call = tool.call;
  if (call.kind == ToolKind::kNone) {
    rig.drop(true, true);
    return;
  }
  if (is_position_tool(call.kind)) {
    call.at_present = away == 0.0;
    call.p_SA = rig.command().p + away * kAway;
    call.p_SE = rig.command().p + away * kAway + 0.03 * call.direction_S;
    call.approach = approach;
  }
  rig.call(call);
}

// About an axis across the tip's, frame M.
Vec3 across(const CaseRig& rig) {
  return rig.to_master((rig.command().q * Vec3::UnitZ()).unitOrthogonal());
}

// The tip's axis circles around the one that an F-rotation keeps, `tilt` from it, and the hand
// turns no more than it must. Near the pole the way back turns about the axis far more than the
// hand does.
ToolCase circle(double tilt, double rounds_per_second, bool governor) {
  CaseRig rig(fmt::format("f-rotation, the hand circles at {:g} deg, {:g} times a second",
                          tilt / kDeg, rounds_per_second),
              governor);
  const Vec3 about = across(rig);
  const Vec3 kept = rig.to_master(rig.command().q * Vec3::UnitZ());
  rig.call(tool_of(ToolKind::kFRotation));
  rig.go(Vec3::Zero(), tilt * about, 1500);
  const Quat step = rotation_exp(2.0 * kHalf * rounds_per_second * 1e-3 * kept);
  Vec3 axis = rotation_exp(tilt * about) * kept;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 next = step * axis;
    const Pose& X = rig.hand();
    rig.tick({X.p, (smallest_turn(axis, next) * X.q).normalized()});
    axis = next;
  }
  rig.rest();
  return rig.finish();
}

ToolCase turning_hand(const char* name, double speed, bool tool, bool governor) {
  CaseRig rig(fmt::format("the hand turns by 20 rad at {:g} rad/s{}", speed, name), governor);
  const Vec3 axis = tool ? across(rig) : kAbout;
  if (tool) rig.call(tool_of(ToolKind::kFRotation));
  const int ticks = static_cast<int>(20.0 / speed * 1e3);
  for (int i = 0; i < ticks; ++i) {
    const Pose& X = rig.hand();
    rig.tick({X.p, (rotation_exp(1e-3 * speed * axis) * X.q).normalized()});
  }
  rig.rest();
  return rig.finish();
}

// A hand that is somewhere else from one reading to the next, `times` times, 20 ms apart.
ToolCase jumping_hand(double turn, int times, bool governor) {
  CaseRig rig(fmt::format("the hand jumps by {:.10g} deg, {} times", turn / kDeg, times), governor);
  for (int i = 0; i < times; ++i) {
    const Pose X = rig.hand();
    rig.tick({X.p, (rotation_exp(turn * Vec3::Unit(i % 3)) * X.q).normalized()});
    rig.stand(19);
  }
  rig.rest();
  return rig.finish();
}

ToolCase turned_hand(ToolKind kind, double turn, bool trembles, bool governor) {
  CaseRig rig(fmt::format("{} with the hand turned by {:.10g} deg{}",
                          kind == ToolKind::kNone ? "orientation tool dropped" : name_of(kind),
                          turn / kDeg, trembles ? ", trembling" : ""),
              governor);
  const Vec3 about = across(rig);
  rig.call(tool_of(ToolKind::kNRotation));  // the command stays where it is meanwhile
  rig.go(Vec3::Zero(), turn * about, 2000);
  if (kind == ToolKind::kNone) {
    rig.drop(false, true);
  } else {
    rig.call(tool_of(kind));
  }
  const Pose X = rig.hand();
  for (int i = 0; trembles && i < 2000; ++i) {
    const Vec3 tremor = 1e-3 * std::sin(0.06 * i) * about + 1e-6 * Vec3::Unit(i % 3);
    rig.tick({X.p, (rotation_exp(tremor) * X.q).normalized()});
  }
  rig.rest();
  return rig.finish();
}

}  // namespace

std::vector<ToolCase> tool_change_cases() {
  struct Change {
    double away, turned;
    bool approach;
  };
  constexpr Change kChanges[] = {{0.0, 0.0, false},
                                 {0.005, 30.0 * kDeg, false},
                                 {0.050, 90.0 * kDeg, false},
                                 {0.050, 90.0 * kDeg, true}};
  const std::vector<CaseTool> tools = named_tools();
  std::vector<ToolCase> out;
  for (const CaseTool& from : tools) {
    for (const CaseTool& to : tools) {
      if (from.call.kind == ToolKind::kNone && to.call.kind == ToolKind::kNone) continue;
      for (const Change& change : kChanges) {
        CaseRig rig(fmt::format("{} to {}, {:g} mm away{}, hand turned by {:g} deg", from.name,
                                to.name, change.away / kMm, change.approach ? " by approach" : "",
                                change.turned / kDeg),
                    out.size() % 2 == 1);
        if (from.call.kind != ToolKind::kNone) change_to(from, 0.0, false, rig);
        rig.go(0.5 * change.away * kAbout, change.turned * kAway, 500);
        change_to(to, change.away, change.approach, rig);
        rig.rest();
        out.push_back(rig.finish());
      }
    }
  }
  return out;
}

std::vector<ToolCase> turned_hand_cases() {
  std::vector<ToolCase> out;
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation, ToolKind::kNone}) {
    for (const double turn : {0.0, 1e-12, 0.5 * kHalf, 179.999999 * kDeg, kHalf}) {
      for (const bool trembles : {false, true}) {
        for (const bool governor : {false, true}) {
          out.push_back(turned_hand(kind, turn, trembles, governor));
        }
      }
    }
  }
  return out;
}

std::vector<ToolCase> parallel_axis_cases() {
  std::vector<ToolCase> out;
  const auto run = [&out](const std::string& name, const ToolCall& first, const ToolCall& second,
                          Reason expected) {
    CaseRig rig(name, out.size() % 2 == 1);
    if (first.kind != ToolKind::kNone) rig.call(first);
    rig.call(second, expected);
    rig.go(0.02 * kAway, 0.5 * kAbout, 500);
    rig.go(-0.03 * kAbout, 1.0 * kAway, 500);
    rig.rest();
    out.push_back(rig.finish());
  };
  for (const double beside : {0.0, 1e-12, 1e-9, 2e-6, 1e-3}) {
    for (const double sign : {1.0, -1.0}) {
      const std::string how =
          fmt::format("{:g} rad from {}", beside, sign > 0.0 ? "parallel" : "opposite");
      ToolCall line = tool_of(ToolKind::kLine), other = line;
      other.direction_S =
          sign * line.direction_S.normalized() + beside * line.direction_S.unitOrthogonal();
      run("line to a line " + how, line, other, Reason::kNone);
      ToolCall plane = tool_of(ToolKind::kPlane), turned = plane;
      turned.normal_S =
          sign * plane.normal_S.normalized() + beside * plane.normal_S.unitOrthogonal();
      run("plane to a plane " + how, plane, turned, Reason::kNone);
      // Forward across the plane: below a millionth of a radian there is no direction within it.
      ToolCall forward = plane;
      forward.direction_S = turned.normal_S;
      forward.one_way = true;
      run("plane with forward and normal " + how, {}, forward,
          beside > 1e-6 ? Reason::kNone : Reason::kToolDirectionZero);
      CaseRig rig("f-rotation about an axis " + how + " to the tip's", out.size() % 2 == 1);
      ToolCall axis = tool_of(ToolKind::kFRotation);
      const Vec3 own = rig.command().q * Vec3::UnitZ();
      axis.has_axis = true;
      axis.axis_S = sign * own + beside * own.unitOrthogonal();
      rig.call(axis);
      rig.go(0.02 * kAway, 2.0 * kAbout, 800);
      rig.rest();
      out.push_back(rig.finish());
    }
  }
  return out;
}

std::vector<ToolCase> half_turn_cases() {
  std::vector<ToolCase> out;
  for (const bool governor : {false, true}) {
    for (const double speed : {0.5, 3.0, 10.0}) {
      out.push_back(turning_hand("", speed, false, governor));
      out.push_back(turning_hand(", f-rotation", speed, true, governor));
    }
    for (const double turn : {0.5 * kHalf, 179.999999 * kDeg, kHalf}) {
      for (const int times : {1, 2, 3, 5}) out.push_back(jumping_hand(turn, times, governor));
    }
    for (const double tilt : {90.0, 150.0, 170.0, 174.0}) {
      for (const double rounds : {1.0, 3.0, 5.0}) {
        out.push_back(circle(tilt * kDeg, rounds, governor));
      }
    }
  }
  return out;
}

}  // namespace handrail
