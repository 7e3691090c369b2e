// Signed distance to the walls of a painted map, between its pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/constraint/painted/subpixel_patch.h"

namespace handrail {

// Distance is kept near walls only, in tiles of 8 x 8 pixels: one sample a pixel, four a pixel
// along each axis where walls or gaps are thin, curves tight or surfaces end. Between samples a
// biquadratic B-spline, so that the normal has no steps. Lengths are pixels, positions X right and
// Y up from the map's lower left corner.
class SubpixelField {
 public:
  // Allocates. `gone`: bits of wall regions that are free.
  SubpixelField(const CoverageMap& map, std::uint64_t gone);

  struct Probe {
    double distance = 0.0;         // positive in free space; beyond 3 (fine: 1.5) a lower bound
    Vec2 gradient = Vec2::Zero();  // of the distance; zero far from walls
    double bend = 0.0;             // of the distance across the gradient: 1/radius, + convex wall
    bool fine = false;             // sampled finely: walls here may be one pixel thin
  };
  // Real-time safe.
  Probe at(const Vec2& p) const noexcept;

  std::size_t memory() const noexcept;

 private:
  struct Build;
  static constexpr int kTile = 8;

  // What a cell of a tile's size is: free, with no wall within a number of rings of cells around;
  // deep, all wall; or a tile, whose samples begin at `first`, a multiple of 4.
  class Cell {
   public:
    static constexpr std::uint32_t kMostRings = 254;
    static Cell free(std::uint32_t rings) noexcept { return Cell(rings); }
    static Cell deep() noexcept { return Cell(kDeep); }
    static Cell tile(std::size_t first, bool fine) noexcept {
      return Cell(kTiles + static_cast<std::uint32_t>(first / 4 * 2) + (fine ? 1 : 0));
    }
    bool is_free() const noexcept { return bits_ < kDeep; }
    bool is_tile() const noexcept { return bits_ >= kTiles; }
    std::uint32_t rings() const noexcept { return bits_; }
    bool fine() const noexcept { return (bits_ & 1) != 0; }
    std::size_t first() const noexcept { return (bits_ - kTiles) / 2 * 4; }

   private:
    static constexpr std::uint32_t kDeep = kMostRings + 1, kTiles = kDeep + 1;
    explicit Cell(std::uint32_t bits) noexcept : bits_(bits) {}
    std::uint32_t bits_;
  };

  void sort_cells(Build& build) const;
  void find_surface(Build& build) const;
  void sort_surface(const std::vector<SurfacePatch>& found, Build& build) const;
  // At the cell's border or in it.
  bool has_edge(const Build& build, int cx, int cy) const;
  void fill(const Build& build, int cx, int cy, bool fine, std::int16_t* samples) const;
  void stand_cores(const Build& build, int cx, int cy, double* value) const;
  void mark_rings();

  std::size_t cell(int cx, int cy) const noexcept {
    return static_cast<std::size_t>(cy) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cx);
  }

  int columns_ = 0, rows_ = 0;  // of cells: the map's tiles and one all around
  std::vector<Cell> cells_;
  std::vector<std::int16_t> samples_;
};

}  // namespace handrail
