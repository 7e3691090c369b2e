// The proxy among painted or drawn walls: the nearest surface point of dissertation chapter 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "server/base/plane.h"
#include "server/model/walls.h"

namespace handrail {

struct WallContact {
  Vec2 proxy = Vec2::Zero();   // in free space, map frame [m]
  Vec2 normal = Vec2::Zero();  // unit, out of the wall; zero while the hand is free
  bool touching = false;       // a wall is between hand and proxy
  std::uint8_t region = 0;     // that the proxy is in: free or aisle
  std::uint8_t wall = 0;       // touching: the wall's region
  int work = 0;                // evaluations of the boundary, of the method's bound
  bool unfinished = false;     // the bound was met: the proxy goes on toward its place next tick
};

// A proxy that moves from where it was toward the hand without leaving free space and comes to rest
// at a local minimum of distance over the part of free space it is in (published: as Algorithm 1
// does). Map frame. It never crosses a wall, however fast the hand, and never leaves the map, whose
// border is wall. Real-time safe but for construction: no allocation, bounded work.
class WallProxy {
 public:
  virtual ~WallProxy() = default;

  // Puts the proxy at the free point nearest to `hand`, near by; from far inside a wall, at the
  // scene's start. Returns it.
  virtual Vec2 start(const Vec2& hand) noexcept = 0;
  // The hand is at `hand` now. A hand that is not finite counts as one that has not moved.
  virtual WallContact advance(const Vec2& hand) noexcept = 0;
  // Wall regions in `gone` (bit = region) are free from now on; others are back. A proxy caught
  // inside a wall that came back is put to the nearest free point.
  virtual void set_gone(std::uint64_t gone) noexcept = 0;
  // What start() and advance() leave behind, as it lies in the memory of this build, without
  // addresses: restored to a proxy among the same walls, it goes on from there, bit for bit. save()
  // returns how much of `out` it took; restore() is false, and nothing is changed, where it is not
  // as much. Real-time safe.
  static constexpr std::size_t kMostImage = 256;
  virtual std::size_t save(std::span<std::byte, kMostImage> out) const noexcept = 0;
  virtual bool restore(std::span<const std::byte> image) noexcept = 0;
  // Memory held [bytes].
  virtual std::size_t memory() const noexcept = 0;
};

}  // namespace handrail
