#include "server/lab/stability/bench_scene.h"

#include <limits>

namespace handrail {
namespace {

// All chosen. A room that no kick crosses, within what counts as a place; a map of 40 mm.
constexpr double kRoom = 4.0;
constexpr int kPixels = 400;
constexpr double kPixel = 0.1e-3;           // [m]
constexpr double kViscosity = 20.0;         // of the region [N s/m]
constexpr double kProgress = 500.0;         // of the progressive friction [N s/(m rad)]
constexpr double kCentre = 30e-3;           // it turns about a point so far away [m]
constexpr double kForceShare = 0.3;         // of the device's peak, where an effect has a force
constexpr double kDetentRadius = 4e-3;      // [m]
constexpr double kReturnStiffness = 100.0;  // [N/m]
constexpr double kCoupling = 2500.0;        // of sliders and the one-way aisle [N/m]

std::shared_ptr<const CoverageMap> thin_map() {
  auto map = std::make_shared<CoverageMap>();
  map->width = map->height = kPixels;
  map->pixel = kPixel;
  const auto size = static_cast<std::size_t>(kPixels) * kPixels;
  map->open.assign(size, 65535);
  map->region.assign(size, 0);
  map->wall.assign(size, 1);
  for (std::size_t i = kPixels / 2; i < size; i += kPixels) {
    map->open[i] = 0;
    map->region[i] = 1;
  }
  return map;
}

EffectSpec spec_of(EffectKind kind, double peak_force) {
  EffectSpec e;
  e.kind = kind;
  e.coupling = e.stiffness = kCoupling;
  e.c = kProgress;
  e.at = Vec2::Zero();
  e.peak = kForceShare * peak_force;
  e.radius = kDetentRadius;
  if (kind == EffectKind::kProgressive) e.at = Vec2(-kCentre, 0.0);
  if (kind == EffectKind::kReturn) e.stiffness = kReturnStiffness;
  if (kind == EffectKind::kDetent) {
    e.places = {Vec2::Zero()};
    e.place_names = {"middle"};
  }
  return e;
}

}  // namespace

Scene bench_scene(const WallCell& cell) {
  auto walls = std::make_shared<Walls>();
  WallRegion room, wall;
  room.name = "room";
  room.kind = RegionKind::kAisle;
  room.viscosity = kViscosity;
  room.one_way = Vec2::UnitY();
  room.progressive = true;
  wall.name = "wall";
  wall.kind = RegionKind::kWall;
  wall.stiffness = cell.stiffness;
  wall.damping = cell.damped ? cell.device->damping : 0.0;
  walls->regions = {room, wall};
  walls->outside = 1;
  walls->stages = {WallStage()};
  // Effects that are not at the wall meet it a little further.
  const double off = cell.at_wall ? 0.0 : 0.5 * kDetentRadius;
  if (cell.form == WallForm::kThin) {
    walls->method = WallMethod::kSubpixel;
    walls->map = thin_map();
    walls->start = Vec2(-1e-3, 0.0);
  } else {
    walls->method = WallMethod::kExact;
    WallShape shape;
    shape.half = Vec2(kRoom, kRoom);
    shape.centre = Vec2(off - kRoom, cell.form == WallForm::kCorner ? -kRoom : 0.0);
    walls->shapes = {shape};
    walls->start = Vec2(-1e-3, -1e-3);
  }
  Scene scene;
  scene.name = "bench";
  scene.walls = walls;
  for (const EffectKind kind : cell.effects) {
    scene.effects.push_back(spec_of(kind, cell.device->capabilities.max_force));
  }
  return scene;
}

}  // namespace handrail
