#include "server/lab/scenes/preview.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/joystick/joystick_data.h"
#include "server/base/units.h"
#include "server/constraint/drawn/outline.h"
#include "server/constraint/drawn/wall_shape.h"
#include "server/lab/scenes/legend.h"
#include "server/lab/scenes/view.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

constexpr double kPreviewMargin = 6e-3;  // around drawn shapes [m]
constexpr double kWandering = 12.0;      // [s]
constexpr double kPreviewTick = 1e-3;    // [s]
constexpr int kGrid = 32;               // arrows along the longer side [1], chosen to be told apart
constexpr double kLongestArrow = 0.95;  // of the grid's width: none reaches the next
constexpr double kNear = 12e-3;  // a proxy further from the hand is not what it would feel [m]
constexpr double kLeast = 0.05;  // a force below this is not drawn [N]
constexpr double kLongest =
    1e-3;                         // a proxy that goes further within a tick went round a corner [m]
constexpr int kLeastWidth = 460;  // of the picture: the longest line of the legend [pixels]

// Of lines, and half the size of marks [pixels].
constexpr double kHandLine = 1.4, kProxyLine = 3.0, kStartDot = 6.0, kLeftOutCross = 2.5;

// Between the walls' frame and the picture.
struct Scale {
  View view;
  double per_metre = 1.0;  // [pixels/m]

  explicit Scale(const View& v) : view(v), per_metre(kPreviewSide / (2.0 * v.half().maxCoeff())) {}
  int width() const { return pixels(2.0 * view.half().x()); }
  int height() const { return pixels(2.0 * view.half().y()); }
  double spacing() const { return 2.0 * view.half().maxCoeff() / kGrid; }  // of arrows [m]
  Vec2 to_picture(const Vec2& p) const {
    return per_metre * Vec2(p.x() - view.low.x(), view.high.y() - p.y());
  }
  Vec2 to_walls(double x, double y) const {
    return Vec2(view.low.x() + x / per_metre, view.high.y() - y / per_metre);
  }

 private:
  int pixels(double metres) const {
    return std::max(1, static_cast<int>(std::lround(metres * per_metre)));
  }
};

// Which region a point is in.
class Ground {
 public:
  explicit Ground(const Walls& walls) : walls_(walls) {
    if (!walls.map) outline_.emplace(walls.shapes, walls.fillet);
  }

  std::uint8_t region_at(const Vec2& p) const {
    if (walls_.map) {
      const CoverageMap& map = *walls_.map;
      const int x = static_cast<int>(std::floor(p.x() / map.pixel + 0.5 * map.width));
      const int y = static_cast<int>(std::floor(0.5 * map.height - p.y() / map.pixel));
      return map.region[static_cast<std::size_t>(std::clamp(y, 0, map.height - 1)) *
                            static_cast<std::size_t>(map.width) +
                        static_cast<std::size_t>(std::clamp(x, 0, map.width - 1))];
    }
    if (!outline_->is_free(p, outline_->nearest(p))) return walls_.outside;
    // A fillet belongs to the nearest shape.
    const WallShape* nearest = &walls_.shapes[0];
    for (const WallShape& shape : walls_.shapes) {
      if (outside_by(shape, p) < outside_by(*nearest, p)) nearest = &shape;
      if (outside_by(*nearest, p) <= 0.0) break;
    }
    return nearest->region;
  }

 private:
  const Walls& walls_;
  std::optional<Outline> outline_;
};

// Paler than painted, so that arrows and ways stand out.
Colour colour_of(const Walls& walls, std::uint8_t index) {
  constexpr Colour kFree = {255, 255, 255}, kAisle = {195, 215, 240}, kWall = {50, 50, 62};
  const WallRegion& region = walls.regions[index];
  Colour colour = walls.map                           ? region.rgb
                  : region.kind == RegionKind::kWall  ? kWall
                  : region.kind == RegionKind::kAisle ? kAisle
                                                      : kFree;
  for (auto& c : colour) c = static_cast<std::uint8_t>(255 - (255 - c) * 2 / 5);
  return colour;
}

void draw_ground(const Walls& walls, const Scale& scale, Canvas& canvas) {
  const Ground ground(walls);
  for (int y = 0; y < scale.height(); ++y) {
    for (int x = 0; x < scale.width(); ++x) {
      canvas.set(x, y, colour_of(walls, ground.region_at(scale.to_walls(x + 0.5, y + 0.5))));
    }
  }
}

// The step of the first stage, its hand in the frame of the walls.
class Hand {
 public:
  explicit Hand(const Scene& scene)
      : pose_(scene.walls->stages[0].pose), run_(make_wall_run(scene, joystick_capabilities())) {}

  const WallOutput& at(const Vec2& hand, const Vec2& velocity = Vec2::Zero()) {
    const Vec2 p = pose_.to_world(hand), v = Pose2::turned(velocity, pose_.angle);
    in_.hand.X_MH.p = Vec3(p.x(), p.y(), 0.0);
    in_.hand.v_MH = Vec3(v.x(), v.y(), 0.0);
    in_.hand.valid = true;
    wall_step(run_->settings, in_, kPreviewTick, run_->state, out_);
    return out_;
  }
  // The hand is gone long enough to start anew where it comes back.
  void lift() {
    in_.hand.valid = false;
    for (int i = 0; i < 30; ++i) wall_step(run_->settings, in_, kPreviewTick, run_->state, out_);
  }

 private:
  Pose2 pose_;
  std::unique_ptr<WallRun> run_;
  WallInput in_;
  WallOutput out_;
};

void draw_forces(const Scene& scene, const Scale& scale, Canvas& canvas) {
  constexpr int kSettle = 120;  // ticks until what comes on gradually is there
  Hand hand(scene);
  const double spacing = scale.spacing();
  for (double y = scale.view.low.y() + 0.5 * spacing; y < scale.view.high.y(); y += spacing) {
    for (double x = scale.view.low.x() + 0.5 * spacing; x < scale.view.high.x(); x += spacing) {
      const Vec2 p(x, y);
      hand.lift();
      WallOutput out;
      for (int i = 0; i < kSettle; ++i) out = hand.at(p);
      const Vec2 force = out.effects.force;
      if ((out.contact.proxy - p).norm() > kNear) {
        draw_cross(canvas, scale.to_picture(p), kLeftOutCross, kForceColour);
        continue;
      }
      if (force.norm() < kLeast) continue;
      const double share = std::min(1.0, force.norm() / kJoystickPeakForce);
      const Vec2 way = kLongestArrow * spacing * std::sqrt(share) * force.normalized();
      canvas.arrow(scale.to_picture(p), scale.to_picture(p + way), 1.6, kForceColour);
    }
  }
}

void draw_ways(const Scene& scene, const Scale& scale, Canvas& canvas) {
  struct Place {
    Vec2 hand, proxy;
  };
  Hand hand(scene);
  std::vector<Place> ways;
  for (double t = 0.0; t < kWandering; t += kPreviewTick) {
    const Vec2 p = wander(*scene.walls, scale.view, t);
    ways.push_back({p, hand.at(p).contact.proxy});
  }
  constexpr std::size_t kEach = 5;  // ticks a stroke
  for (std::size_t i = kEach; i < ways.size(); i += kEach) {
    canvas.line(scale.to_picture(ways[i - kEach].hand), scale.to_picture(ways[i].hand), kHandLine,
                kHandColour);
  }
  // Around a corner a proxy goes in one tick along the wall; no straight line is drawn there.
  for (std::size_t i = 1; i < ways.size(); ++i) {
    if ((ways[i].proxy - ways[i - 1].proxy).norm() > kLongest) continue;
    canvas.line(scale.to_picture(ways[i - 1].proxy), scale.to_picture(ways[i].proxy), kProxyLine,
                kProxyColour);
  }
  canvas.disc(scale.to_picture(scene.walls->start), kStartDot, kStartColour);
}

// Of the regions: as they are named, and what they are to the hand.
void add_regions(const Walls& walls, Legend& legend) {
  constexpr const char* kKinds[] = {"free", "wall", "aisle"};
  std::vector<std::string> said;
  for (std::size_t i = 0; i < walls.regions.size(); ++i) {
    const WallRegion& region = walls.regions[i];
    const char* kind = kKinds[static_cast<std::size_t>(region.kind)];
    // Drawn shapes have the colour of their kind.
    const std::string words =
        !walls.map || region.name == kind ? kind : fmt::format("{} ({})", region.name, kind);
    if (std::find(said.begin(), said.end(), words) != said.end()) continue;
    said.push_back(words);
    legend.add(
        {LegendEntry::Mark::kArea, colour_of(walls, static_cast<std::uint8_t>(i)), 0.0, words});
  }
}

Legend legend_of(const Walls& walls, const Scale& scale, int width) {
  using Mark = LegendEntry::Mark;
  Legend out(width, scale.per_metre);
  add_regions(walls, out);
  out.add({Mark::kDot, kStartColour, kStartDot, "start"});
  out.add({Mark::kLine, kHandColour, kHandLine, "a hand that wanders"});
  out.add({Mark::kLine, kProxyColour, kProxyLine,
           fmt::format("its proxy; leaps over {:g} mm are left out", kLongest / kMm)});
  out.add({Mark::kArrow, kForceColour, kLongestArrow * scale.spacing() * scale.per_metre,
           fmt::format("{:.0f} N on a hand at rest; half as long: a quarter", kJoystickPeakForce)});
  out.add({Mark::kCross, kForceColour, kLeftOutCross,
           fmt::format("no arrow: its proxy is over {:g} mm away", kNear / kMm)});
  out.add({Mark::kNone, {}, 0.0, fmt::format("neither arrow nor cross: below {:g} N", kLeast)});
  return out;
}

}  // namespace

Result<Canvas> preview_scene(const Scene& scene) {
  if (!scene.walls) {
    return Status::error(scene.file + ": the scene has no walls to draw");
  }
  const Scale scale(view_of(*scene.walls, kPreviewMargin));
  const int width = std::max(scale.width(), kLeastWidth);
  const Legend legend = legend_of(*scene.walls, scale, width);
  Canvas canvas(width, scale.height() + legend.height(), {255, 255, 255});
  draw_ground(*scene.walls, scale, canvas);
  draw_forces(scene, scale, canvas);
  draw_ways(scene, scale, canvas);
  legend.draw(canvas, scale.height());
  return canvas;
}

}  // namespace handrail
