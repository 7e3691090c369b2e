// Painted or drawn walls of a two-axis scene (dissertation chapter 2), immutable once loaded. SI.
//
// Map frame: the plane of the device, X right, Y up, origin at the image's centre or the drawing's
// own origin. `pose` puts it into M.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/plane.h"

namespace handrail {

enum class RegionKind : std::uint8_t { kFree, kWall, kAisle };  // the hand may be in free and aisle

// What one colour of the palette, or one drawn shape's filling, means.
struct WallRegion {
  std::string name;
  RegionKind kind = RegionKind::kFree;
  std::array<std::uint8_t, 3> rgb{};
  double stiffness = 5000.0;    // walls: K of (2.1) [N/m]
  double damping = 0.0;         // walls: B of (2.1) [N s/m]
  double viscosity = 0.0;       // free and aisle: against the hand's motion [N s/m]
  Vec2 one_way = Vec2::Zero();  // aisle: unit, motion against it is held; zero: both ways
  bool progressive = false;     // aisle: the progressive friction effect acts here
  // Free and aisle, painted: each of its patches is a place of the detent effect.
  struct Detent {
    double radius = 0.0;  // of the pull [m]; 0: of a disc as large as the patch
    double peak = 0.0;    // [N]; 0: the effect's
  };
  std::optional<Detent> detent;
};

enum class WallMethod : std::uint8_t {
  kPublished,  // Algorithm 1 on the binary map, with bounded work
  kSubpixel,   // on the anti-aliased boundary
  kExact,      // analytic, on shapes
};

// A painted map after loading: what of each pixel is not wall, in linear light.
struct CoverageMap {
  int width = 0, height = 0;         // [pixels]
  double pixel = 1e-4;               // edge of one [m]
  std::vector<std::uint16_t> open;   // row by row from the top: 0 all wall, 65535 no wall
  std::vector<std::uint8_t> region;  // the region the pixel mostly is: index into Walls::regions
  std::vector<std::uint8_t> wall;  // the wall region nearest to it, where a wall is within 3 pixels
};

// One drawn piece of free space; free space is their union. Everything else is wall.
struct WallShape {
  enum class Kind : std::uint8_t { kRectangle, kDisc, kArc };
  Kind kind = Kind::kRectangle;
  Vec2 centre = Vec2::Zero();   // of rectangle, disc, or the arc's circle [m]
  Vec2 half = Vec2::Zero();     // rectangle: half its sides [m]
  double angle = 0.0;           // rectangle: turned by [rad]
  double radius = 0.0;          // disc; arc: of its middle line [m]
  double width = 0.0;           // arc: of the aisle [m]
  double from = 0.0, to = 0.0;  // arc: counter-clockwise from .. to, to > from [rad]
  std::uint8_t region = 0;      // index into Walls::regions, not a wall
};

// What puts a stage in force by itself, at the moment it becomes true.
struct StageCondition {
  enum class Kind : std::uint8_t {
    kNone,         // only an order does
    kInside,       // the hand's place is in region `index`
    kTurnedOver,   // progressive friction has been turned by more than `angle`
    kTurnedUnder,  // by less
    kLocked,       // place `index` of the detent has locked
    kUnlocked,     // it holds no longer
  };
  Kind kind = Kind::kNone;
  std::uint8_t index = 0;
  double angle = 0.0;  // [rad]
};

// Most stages of a scene.
inline constexpr int kMostStages = 64;

// The walls as they are from one stage of the task on.
struct WallStage {
  std::string name;
  Pose2 pose;                        // of the map in M
  std::vector<std::uint8_t> gone;    // wall regions that are not there in this stage
  std::vector<WallRegion> regions;   // as they are in this stage; empty: as the walls list them
  std::vector<double> detent_peaks;  // of each place, 0: not there [N]; empty: as listed
  StageCondition when;
};

// The regions that a stage leaves out, a bit each. Real-time safe.
inline std::uint64_t gone_of(const WallStage& stage) noexcept {
  std::uint64_t bits = 0;
  for (const std::uint8_t region : stage.gone) bits |= std::uint64_t{1} << (region & 63u);
  return bits;
}

struct Walls {
  WallMethod method = WallMethod::kSubpixel;
  double search_radius = 1.5;              // published: epsilon [pixels]
  std::vector<WallRegion> regions;         // at most 64
  std::string image;                       // file of the painted map; empty: drawn
  std::shared_ptr<const CoverageMap> map;  // painted
  std::vector<WallShape> shapes;           // drawn
  double fillet = 0.0;                // drawn: radius that rounds wall corners at junctions [m]
  std::uint8_t outside = 0;           // drawn: the wall region around the shapes
  Vec2 start = Vec2::Zero();          // a point of free space, map frame [m]
  std::vector<WallStage> stages;      // at least one; the first is in force at the start
  std::vector<std::string> warnings;  // one sentence each: allowed, but likely to surprise

  // Region `index` as it is in `stage`. Both must be there. Real-time safe.
  const WallRegion& region(std::size_t stage, std::uint8_t index) const noexcept {
    const bool own = stage < stages.size() && !stages[stage].regions.empty();
    return (own ? stages[stage].regions : regions)[index];
  }
};

}  // namespace handrail
