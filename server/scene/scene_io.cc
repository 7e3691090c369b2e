#include "server/scene/scene_io.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/base/units.h"
#include "server/painting/map_detent.h"
#include "server/scene/effect_io.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"
#include "server/scene/scene_limits_io.h"
#include "server/scene/simulate_io.h"
#include "server/scene/text_io.h"
#include "server/scene/tool_io.h"
#include "server/scene/wall_stages_io.h"
#include "server/scene/walls_io.h"
#include "server/scene/workpiece_reach.h"

namespace handrail {
namespace {

constexpr int kPublishedSamples = 200;
constexpr int kLowLagSamples = 105;
constexpr double kRotationTolerance = 1e-6;

Problem name_from(const pb::Scene& in, const std::string& path, Scene& out) {
  out.name = in.name();
  if (!is_scene_name(out.name)) {
    return FieldProblem{"name",
                        "'" + out.name + "', expected 1 to 47 letters, digits, '-' and '_'"};
  }
  const std::string stem = std::filesystem::path(path).stem().string();
  if (out.name == stem) return std::nullopt;
  return FieldProblem{"name", "'" + out.name + "' differs from the file's name '" + stem + "'"};
}

Problem mapping_from(const pb::Mapping& in, Scene::Mapping& out) {
  out.scale = in.scale();
  out.absolute = in.absolute();
  if (in.absolute() && in.tip_centre_mm_size() == 0) {
    return FieldProblem{"mapping.tip_centre_mm", "missing, but an absolute mapping needs it"};
  }
  for (const bool tip : {false, true}) {
    const bool given = (tip ? in.tip_centre_mm_size() : in.hand_centre_mm_size()) > 0;
    if (!given || in.absolute()) continue;
    return FieldProblem{tip ? "mapping.tip_centre_mm" : "mapping.hand_centre_mm",
                        "only used with absolute: true"};
  }
  out.hand_centre = vector_of(in.hand_centre_mm()) * kMm;
  out.tip_centre = vector_of(in.tip_centre_mm()) * kMm;
  if (in.rotation_size() == 0) return std::nullopt;
  for (int i = 0; i < 9; ++i) out.R_SM(i / 3, i % 3) = in.rotation(i);
  const double error = (out.R_SM.transpose() * out.R_SM - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance) {
    return FieldProblem{"mapping.rotation", "columns are off unit length or right angles by " +
                                                number_text(std::round(error * 1e9) / 1e9)};
  }
  if (out.R_SM.determinant() < 0.0) {
    return FieldProblem{"mapping.rotation", "determinant -1 mirrors, expected a rotation (+1)"};
  }
  // Rounded decimals become the rotation they were meant as.
  if (error > 1e-12) out.R_SM = Quat(out.R_SM).normalized().toRotationMatrix();
  return std::nullopt;
}

void guidance_from(const pb::Guidance& in, Scene::Guidance& out) {
  out.published_method = in.method() == pb::Guidance::PUBLISHED;
  out.delta = in.delta_mm() * kMm;
  out.stiffness = in.stiffness_n_mm() * kNewtonPerMm;
  out.damping = in.damping_n_s_mm() * kNewtonPerMm;
  out.torque_stiffness = in.torque_stiffness_n_m_rad();
  out.spring = in.spring_n_mm() * kNewtonPerMm;
  out.catch_up = in.catch_up_mm_s() * kMm;
  out.catch_up_rotation = in.catch_up_deg_s() * kDeg;
  out.tool_reach = in.tool_reach_mm() * kMm;
  out.local_surface = in.local_surface();
  out.chase = in.release() == pb::Guidance::CHASE;
}

Problem smoother_from(const pb::Smoother& in, int& samples) {
  const bool by_length = in.form() == pb::Smoother::LENGTH;
  samples = by_length                            ? static_cast<int>(in.samples())
            : in.form() == pb::Smoother::LOW_LAG ? kLowLagSamples
                                                 : kPublishedSamples;
  if (by_length || !in.has_samples() || static_cast<int>(in.samples()) == samples) {
    return std::nullopt;
  }
  return FieldProblem{"smoother.samples", "only used with form: LENGTH"};
}

Problem bumper_from(const pb::Bumper& in, BumperSettings& out) {
  using Form = BumperSettings::Form;
  out.form = in.form() == pb::Bumper::PUBLISHED ? Form::kPublished : Form::kDefault;
  out.enabled = in.enabled();
  out.alpha = in.alpha_mm_n() * kMm;
  out.threshold = in.threshold_n();
  out.dead_band = in.dead_band_n();
  out.contact = in.has_contact_n() ? in.contact_n() : std::min(10.0, 0.2 * out.threshold);
  out.friction = in.friction();
  out.noise = in.noise_n();
  out.sensor_lag = in.sensor_lag_ms() * 1e-3;
  if (in.has_approach()) {
    out.promise = in.approach().force_n();
    out.stiffest = in.approach().stiffness_n_mm() * kNewtonPerMm;
  }
  const auto newtons = [](double n) { return number_text(n) + " N"; };
  const std::string threshold = "the threshold " + newtons(out.threshold);
  if (out.dead_band >= out.threshold) {
    return FieldProblem{in.has_dead_band_n() ? "bumper.dead_band_n" : "bumper.threshold_n",
                        "dead band " + newtons(out.dead_band) + " is not below " + threshold};
  }
  if (out.contact >= out.threshold) {
    return FieldProblem{"bumper.contact_n", newtons(out.contact) + " is not below " + threshold};
  }
  if (out.contact < 5.0 * out.noise) {
    return FieldProblem{in.has_contact_n() ? "bumper.contact_n" : "bumper.noise_n",
                        "a contact is felt at " + newtons(out.contact) + ", which noise of " +
                            newtons(out.noise) + " reaches: expected at least 5 times as much"};
  }
  if (in.has_approach() && out.promise <= out.threshold) {
    return FieldProblem{"bumper.approach.force_n",
                        newtons(out.promise) + " is not above " + threshold};
  }
  return std::nullopt;
}

Problem named_tool_from(const std::string& name, const ToolCall& call, const std::string& path,
                        std::vector<NamedTool>& out) {
  if (!is_scene_name(name)) {
    return FieldProblem{path + ".name",
                        "'" + name + "', expected 1 to 47 letters, digits, '-' and '_'"};
  }
  const auto same = [&](const NamedTool& other) { return other.name == name; };
  if (std::any_of(out.begin(), out.end(), same)) {
    return FieldProblem{path + ".name", "a second '" + name + "', expected another name"};
  }
  if (out.size() == kMostNamedTools) {
    return FieldProblem{path, "one tool with a name more than the " +
                                  std::to_string(kMostNamedTools) + " that a scene may have"};
  }
  out.push_back({name, call});
  return std::nullopt;
}

Problem tools_from(const pb::Scene& in, Scene& out) {
  bool position = false, orientation = false;
  for (int i = 0; i < in.tool_size(); ++i) {
    const std::string path = "tool[" + std::to_string(i) + "]";
    ToolCall call;
    if (Problem p = tool_call_from(in.tool(i), call)) {
      p->path = path + "." + p->path;
      return p;
    }
    if (in.tool(i).has_name()) {
      if (Problem p = named_tool_from(in.tool(i).name(), call, path, out.named_tools)) return p;
      continue;
    }
    if (has_reference(call)) {
      return FieldProblem{path + ".name",
                          "missing, but a tool that turns the arm by itself is called by its name"};
    }
    bool& taken = is_position_tool(call.kind) ? position : orientation;
    if (taken) {
      return FieldProblem{path, std::string("a second ") +
                                    (is_position_tool(call.kind) ? "position" : "orientation") +
                                    " tool, at most one can be active"};
    }
    taken = true;
    out.tools.push_back(call);
  }
  return std::nullopt;
}

Problem check_apart(const char* field, const Vec3& p, const char* other, const Vec3& from) {
  constexpr double kLeast = 1.0 * kMm;
  const double distance = (p - from).norm();
  if (distance >= kLeast) return std::nullopt;
  return FieldProblem{field, number_text(std::round(distance / kMm * 1e6) / 1e6) + " mm from " +
                                 other + ", expected at least " + number_text(kLeast / kMm)};
}

Problem task_from(const pb::LinearTask& in, LinearTask& out) {
  const auto vector = [](const auto& v) { return Vec3(v.Get(0), v.Get(1), v.Get(2)); };
  out.p_SA = vector(in.a_mm()) * kMm;
  out.p_SB = vector(in.b_mm()) * kMm;
  out.p_SC = vector(in.c_mm()) * kMm;
  out.turn = vector(in.turn_deg()) * kDeg;
  if (Problem p = check_apart("task.b_mm", out.p_SB, "a_mm", out.p_SA)) return p;
  if (Problem p = check_apart("task.c_mm", out.p_SC, "a_mm", out.p_SA)) return p;
  return check_apart("task.c_mm", out.p_SC, "b_mm", out.p_SB);
}

// `simulate` has been read.
Problem screw_from(const pb::ScrewTask& in, const std::optional<Simulate>& simulate,
                   ScrewTask& out) {
  if (!simulate || simulate->find<HexSocketSpec>() == nullptr ||
      simulate->find<ScrewThreadSpec>() == nullptr) {
    return FieldProblem{"screw",
                        "no screw to fasten: expected a hex_socket and a screw_thread in simulate"};
  }
  out.start = Vec3(in.start_mm(0), in.start_mm(1), in.start_mm(2)) * kMm;
  out.tight = in.tight_deg() * kDeg;
  out.clear = in.clear_mm() * kMm;
  const Vec3 out_of_it = simulate->find<HexSocketSpec>()->X_SK.q * Vec3::UnitZ();
  if (out.start.dot(out_of_it) > 0.0) return std::nullopt;
  return FieldProblem{"screw.start_mm", "not above the socket's rim"};
}

// A tip nearer to the wrist's centre than the flange would be inside the wrist.
Problem robot_from(const pb::RobotModel& in, Scene& out) {
  constexpr double kFlange = 85.0;     // from the wrist's centre [mm]
  constexpr double kHalfTurn = 180.0;  // [deg]; more is the other way round
  out.tip_length = in.tip_length_mm() * kMm;
  const Vec3 offset = vector_of(in.mount().offset_mm()), turn = vector_of(in.mount().turn_deg());
  const auto rounded = [](double v) { return number_text(std::round(v * 10.0) / 10.0); };
  const double from_wrist = (offset + in.tip_length_mm() * Vec3::UnitZ()).norm();
  if (from_wrist < kFlange) {
    return FieldProblem{"robot.mount.offset_mm",
                        "the tip would be " + rounded(from_wrist) +
                            " mm from the wrist's centre, expected at least " +
                            number_text(kFlange)};
  }
  if (turn.norm() > kHalfTurn * (1.0 + 1e-12)) {
    return FieldProblem{
        "robot.mount.turn_deg",
        rounded(turn.norm()) + " deg long, expected at most " + number_text(kHalfTurn)};
  }
  const bool straight = offset.isZero(0.0) && turn.isZero(0.0);
  if (!straight) out.X_AT = Pose{offset * kMm, rotation_exp(turn * kDeg)};
  return std::nullopt;
}

Problem scene_from(const pb::Scene& in, const std::string& path, Scene& out) {
  if (Problem p = name_from(in, path, out)) return p;
  out.description = in.description();
  out.file = path;
  if (Problem p = mapping_from(in.mapping(), out.mapping)) return p;
  guidance_from(in.guidance(), out.guidance);
  if (Problem p = smoother_from(in.smoother(), out.smoother_samples)) return p;
  if (Problem p = bumper_from(in.bumper(), out.bumper)) return p;
  if (Problem p = limits_from(in.limits(), out.limits)) return p;
  if (Problem p = robot_from(in.robot(), out)) return p;
  if (in.has_task()) {
    if (Problem p = task_from(in.task(), out.task.emplace())) return p;
  }
  if (in.has_walls()) {
    auto walls = std::make_shared<Walls>();
    if (Problem p = walls_from(in.walls(), *walls)) return p;
    out.walls = std::move(walls);
  }
  if (!in.has_walls() && in.effect_size() > 0) {
    return FieldProblem{"effect[0]", "effects need walls, which this scene has not"};
  }
  const auto& regions = in.walls().region();
  const bool painted = std::any_of(regions.begin(), regions.end(),
                                   [](const pb::WallRegion& r) { return r.has_detent(); });
  if (Problem p = effects_from(in.effect(), out.effects, painted)) return p;
  if (in.has_simulate()) {
    if (in.has_walls()) return FieldProblem{"simulate", "no arm takes part in a scene of walls"};
    if (Problem p = simulate_from(in.simulate(), out.simulate.emplace())) return p;
  }
  if (in.has_screw()) {
    if (Problem p = screw_from(in.screw(), out.simulate, out.screw.emplace())) return p;
  }
  if (Problem p = tools_from(in, out)) return p;
  return out_of_reach(out);
}

// The part that takes long, once everything else is known to be right.
Problem complete(const pb::Scene& in, const std::string& path, Scene& out) {
  if (!out.walls) return std::nullopt;
  auto walls = std::make_shared<Walls>(*out.walls);
  Problem problem = complete_walls(in.walls(), path, *walls);
  if (!problem) problem = paint_detents(*walls, out.effects);
  if (!problem) problem = stage_effects_from(in.walls(), out.effects, *walls);
  out.walls = std::move(walls);
  return problem;
}

}  // namespace

Result<Scene> parse_scene(const std::string& path, std::string_view text, pb::Scene* raw,
                          const std::vector<Override>& overrides) {
  TextSource source;
  pb::Scene message;
  if (Status status = source.parse(path, text, message); !status) return status;
  Scene scene;
  if (const Problem problem = scene_from(message, path, scene)) return source.error_at(*problem);
  if (!overrides.empty()) {
    const auto check = [&](const google::protobuf::Message& changed) -> Problem {
      if (Problem problem = check_fields(changed)) return problem;
      scene = Scene();
      return scene_from(static_cast<const pb::Scene&>(changed), path, scene);
    };
    if (Status status = set_fields(message, overrides, "", check); !status) return status;
  }
  if (const Problem problem = complete(message, path, scene)) return source.error_at(*problem);
  if (raw != nullptr) *raw = message;
  return scene;
}

Result<Scene> load_scene_file(const std::string& path, pb::Scene* raw,
                              const std::vector<Override>& overrides) {
  const Result<std::string> text = read_file(path, TextSource::kMaxBytes);
  if (!text) return text.status();
  return parse_scene(path, *text, raw, overrides);
}

}  // namespace handrail
