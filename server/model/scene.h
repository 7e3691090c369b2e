// A scene: what master and slave must agree on, immutable once loaded. SI, without protobuf.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/base/units.h"
#include "server/model/bumper_settings.h"
#include "server/model/effect_list.h"
#include "server/model/linear_task.h"
#include "server/model/link_state.h"
#include "server/model/screw_task.h"
#include "server/model/simulate.h"
#include "server/model/tool_call.h"
#include "server/model/walls.h"

namespace handrail {

struct Scene {
  // Workspace mapping (3.1), (3.2).
  struct Mapping {
    double scale = 2.0;          // k
    Mat3 R_SM = default_R_SM();  // device axes in the robot base frame
    // (3.1) and (3.2) as printed: the tip is at tip_centre and points straight down where the hand
    // is at hand_centre and turned as its device's frame. Else relative to where both stood.
    bool absolute = false;
    Vec3 hand_centre = Vec3::Zero();  // c_M, frame M [m]
    Vec3 tip_centre = Vec3::Zero();   // c_S, frame S [m]
  };
  // Tools and force on the master's side, but for the catch-up, which the slave keeps too;
  // stiffness and damping at the hand.
  struct Guidance {
    bool published_method = false;           // Algorithm 2 in steps of delta; else the closed form
    double delta = 1e-4;                     // at the hand [m]
    double stiffness = 800.0;                // K_t [N/m]
    double damping = 0.0;                    // B of (2.1) [N s/m]
    double torque_stiffness = 0.5;           // K_N, K_F [N m/rad]
    double spring = 200.0;                   // K_s of (3.3) [N/m]
    double catch_up = 0.060;                 // bound on letting go of a position offset [m/s]
    double catch_up_rotation = 15.0 * kDeg;  // the same for orientation [rad/s]
    double tool_reach = 0.020;               // furthest from the tip that a tool is called [m]
    bool local_surface = false;              // what is touched is rendered at the master
    bool chase = false;  // a released orientation follows the hand at catch_up_rotation at most
  };
  struct Limits {
    JointLimits joints;                         // within Table 3.1
    double tip_speed = 1.0;                     // [m/s]
    Vec3 workspace_low = Vec3::Constant(-2.0);  // the tip's box, frame S [m]
    Vec3 workspace_high = Vec3::Constant(2.0);
  };

  // Device right = base -Y, up = +Z, toward the user = -X.
  static Mat3 default_R_SM() { return (Mat3() << 0, 0, -1, -1, 0, 0, 0, 1, 0).finished(); }

  std::string name;  // letters, digits, '-' and '_'; at most 47
  std::string description;
  std::string file;  // where it was read from
  Mapping mapping;
  Guidance guidance;
  int smoother_samples = 200;  // N of (3.11), at 1 kHz
  BumperSettings bumper;
  Limits limits;
  double tip_length = 0.301;    // wrist centre to A, along the flange's axis [m]
  std::optional<Pose> X_AT;     // the tip, axes of the flange; none: the tip is A
  std::vector<ToolCall> tools;  // called on loading: at most one position and one orientation tool
  std::vector<NamedTool> named_tools;  // called by their names only; at most kMostNamedTools
  std::optional<LinearTask> task;      // what the person is asked to do
  std::optional<ScrewTask> screw;      // the same, with a socket and a thread in `simulate`
  std::shared_ptr<const Walls> walls;  // of a two-axis device; null: none
  std::vector<EffectSpec> effects;     // with walls: what is simulated, and nothing else
  std::optional<Simulate> simulate;    // of the rig, and nothing else; none: as it is configured
};

// Chosen: more than anybody keeps apart by name; they all stand in every status.
inline constexpr std::size_t kMostNamedTools = 32;

// Hashes of what both sides must hold alike: mapping (with the catch-up and the named
// tools), limits (with the bumper,
// which also holds the arm back) and robot, over the SI values. `tools` stays 0: it belongs to the
// tools active, not to the scene. The task and the walls are the operator's business alone, what is
// simulated the simulator's.
SectionHashes section_hashes(const Scene& scene) noexcept;

// One sentence for each setting that is allowed but likely to surprise.
std::vector<std::string> warnings_of(const Scene& scene);

// True for a name that can be a scene's: 1 to 47 letters, digits, '-' and '_'. Such a name is safe
// to look up as a file, whoever sent it.
bool is_scene_name(const std::string& name) noexcept;

}  // namespace handrail
