#include "server/constraint/painted/subpixel_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "server/constraint/painted/subpixel_core.h"
#include "server/constraint/painted/subpixel_corner.h"

namespace handrail {
namespace {

// In brackets: the range in which the tests hold, see WALLS.md. Else derived.
constexpr double kReach = 3.0;      // [1.95, 3.75] distances are kept to here
constexpr double kFineReach = 1.5;  // [0.975, 3] ... in fine tiles
constexpr double kDelicate = 3.3;   // [0, 3.63] tiles this near a delicate piece are fine
// Of a sample: the finest power of 2 by which 16 bits hold kReach.
constexpr double kUnit = 1.0 / 8192;
constexpr int kCoarse = 10, kFine = 34;  // samples along a tile, one beyond each edge
constexpr int kAround = 4;               // fine samples looked at beyond those: 2 kDisc, rounded up
constexpr int kWide = kFine + 2 * kAround;
constexpr double kDisc = 0.4;   // [0.32, 0.5] free space narrower than such a disc is none
constexpr double kNook = 0.08;  // [0.072, 0.12] ... where it is off by more than the grid makes it

constexpr double kBorder = 0.9;  // [0, 0.9] so near its border no whole pixel holds a surface

// From a coordinate to the nearer border of its pixel.
double to_border(double x) { return 0.5 - std::abs(x - std::floor(x) - 0.5); }

// The sample at (i, j) of a fine tile and its surroundings, as if free space were only where a disc
// of kDisc fits: what is left of it by pixels in a corner could hold a proxy.
double without_nooks(const double* value, int i, int j) {
  const double here = value[j * kWide + i];
  if (!(here > -kDisc && here < kDisc)) return here;
  double best = -kDisc;
  for (int dj = -kAround; dj <= kAround; ++dj) {
    for (int di = -kAround; di <= kAround; ++di) {
      const double there = value[(j + dj) * kWide + i + di];
      if (there >= kDisc) best = std::max(best, there - 0.25 * std::hypot(di, dj));
    }
  }
  return here - best > kNook ? best : here;
}

// Which row or column of cells a coordinate is in.
int to_cell(double v) { return static_cast<int>(std::floor(v / 8)) + 1; }

// The samples of a tile while they are made, with those around that a fine one needs.
struct Grid {
  // (x, y): the tile's lower left pixel.
  Grid(int x, int y, bool fine)
      : n(fine ? kWide : kCoarse),
        pitch(fine ? 0.25 : 1.0),
        reach(fine ? kFineReach : kReach),
        x0(x - (fine ? (0.5 + kAround) * pitch : 0.5 * pitch)),
        y0(y - (fine ? (0.5 + kAround) * pitch : 0.5 * pitch)) {}

  Vec2 at(int i, int j) const { return {x0 + i * pitch, y0 + j * pitch}; }
  double& value_at(int i, int j) { return value[static_cast<std::size_t>(j * n + i)]; }
  static double wall_at(const CoverageView& view, const Vec2& p) {
    return view.wall(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
  }

  // By the pixels alone: far on the one side or the other.
  void guess(const CoverageView& view) {
    std::fill_n(rank.begin(), n * n, 1e9);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) value_at(i, j) = wall_at(view, at(i, j)) >= 0.5 ? -reach : reach;
    }
  }

  // The distance to the piece, where no other speaks for the sample with more right.
  void take(const SurfacePatch& piece) {
    const Vec2 middle = piece.at(0.0);
    const auto low = [&](double from) {
      return std::max(static_cast<int>(std::ceil((from - reach - 0.5) / pitch)), 0);
    };
    const auto high = [&](double to) {
      return std::min(static_cast<int>(std::floor((to + reach + 0.5) / pitch)), n - 1);
    };
    for (int j = low(middle.y() - y0); j <= high(middle.y() - y0); ++j) {
      for (int i = low(middle.x() - x0); i <= high(middle.x() - x0); ++i) {
        const SurfacePatch::Distance d = piece.distance(x0 + i * pitch, y0 + j * pitch);
        double& best = rank[static_cast<std::size_t>(j * n + i)];
        if (d.rank >= best) continue;
        best = d.rank;
        // The spline through samples of a curved distance would be off by this.
        value_at(i, j) = d.value - d.bend * pitch * pitch / 8.0;
      }
    }
  }

  // Whatever the pieces say near corners, no surface runs through a pixel all wall or all free.
  void keep_pixels(const CoverageView& view) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Vec2 p = at(i, j);
        const double inside = kBorder * std::min(to_border(p.x()), to_border(p.y()));
        const double w = wall_at(view, p);
        double& v = value_at(i, j);
        if (w >= kFull) v = std::min(v, -inside);
        if (w <= 1.0 - kFull) v = std::max(v, inside);
      }
    }
  }

  int n;
  double pitch, reach;
  double x0, y0;  // of the sample (0, 0)
  std::array<double, kWide * kWide> value, rank;
};

// A biquadratic B-spline's weights of three samples, and those of its slope, at `s` from the middle
// one in samples.
struct Spline {
  explicit Spline(double s)
      : value{0.5 * (0.5 - s) * (0.5 - s), 0.75 - s * s, 0.5 * (0.5 + s) * (0.5 + s)},
        slope{s - 0.5, -2.0 * s, s + 0.5} {}
  static double sum(const double (&weight)[3], const double (&of)[3]) {
    return weight[0] * of[0] + weight[1] * of[1] + weight[2] * of[2];
  }
  double value[3], slope[3];
};

// The spline through 3 x 3 samples, rows `stride` apart, at (s, t) from the middle one, and its
// derivatives; `scale`: samples a pixel.
void spread(const std::int16_t* row, int stride, double s, double t, double scale,
            SubpixelField::Probe& out) {
  const Spline a(s), b(t);
  double f[3], fx[3], fxx[3];
  for (int k = 0; k < 3; ++k, row += stride) {
    const double of[3] = {static_cast<double>(row[0]), static_cast<double>(row[1]),
                          static_cast<double>(row[2])};
    f[k] = Spline::sum(a.value, of);
    fx[k] = Spline::sum(a.slope, of);
    fxx[k] = of[0] - 2.0 * of[1] + of[2];
  }
  out.distance = kUnit * Spline::sum(b.value, f);
  const double unit1 = kUnit * scale, unit2 = unit1 * scale;
  const double gx = unit1 * Spline::sum(b.value, fx);
  const double gy = unit1 * Spline::sum(b.slope, f);
  const double hxx = unit2 * Spline::sum(b.value, fxx);
  const double hxy = unit2 * Spline::sum(b.slope, fx);
  const double hyy = unit2 * (f[0] - 2.0 * f[1] + f[2]);
  out.gradient = {gx, gy};
  const double g2 = gx * gx + gy * gy;
  if (g2 > 1e-6) {
    out.bend = (hxx * gy * gy - 2.0 * hxy * gx * gy + hyy * gx * gx) / (g2 * std::sqrt(g2));
  }
}

}  // namespace

struct SubpixelField::Build {
  CoverageView view;
  enum Kind : std::uint8_t { kFree, kWall, kMixed };
  std::vector<std::uint8_t> kind;     // of each cell
  std::vector<std::uint8_t> tile;     // 0 none, 1 coarse, 2 fine
  std::vector<SurfacePatch> patches;  // by cell
  std::vector<std::uint32_t> first;   // of a cell's patches; one more than cells
  PixelSet explained;                 // by corners of free space
};

SubpixelField::SubpixelField(const CoverageMap& map, std::uint64_t gone)
    : columns_((map.width + kTile - 1) / kTile + 2), rows_((map.height + kTile - 1) / kTile + 2) {
  Build build{CoverageView(map, gone), {}, {}, {}, {}, {}};
  sort_cells(build);
  find_surface(build);
  cells_.reserve(build.kind.size());
  std::size_t size = 0;
  for (std::size_t i = 0; i < build.kind.size(); ++i) {
    const bool fine = build.tile[i] == 2;
    if (build.tile[i] == 0) {
      cells_.push_back(build.kind[i] == Build::kWall ? Cell::deep() : Cell::free(0));
      continue;
    }
    cells_.push_back(Cell::tile(size, fine));
    size += fine ? kFine * kFine : kCoarse * kCoarse;
  }
  samples_.resize(size);
  for (int cy = 0; cy < rows_; ++cy) {
    for (int cx = 0; cx < columns_; ++cx) {
      const Cell c = cells_[cell(cx, cy)];
      if (c.is_tile()) fill(build, cx, cy, c.fine(), &samples_[c.first()]);
    }
  }
  mark_rings();
}

// Which cells are all free, all wall or mixed.
void SubpixelField::sort_cells(Build& build) const {
  const CoverageView& view = build.view;
  build.kind.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                    Build::kWall);
  for (int cy = 1; cy + 1 < rows_; ++cy) {
    for (int cx = 1; cx + 1 < columns_; ++cx) {
      double low = 1.0, high = 0.0;
      for (int y = (cy - 1) * kTile; y < cy * kTile; ++y) {
        for (int x = (cx - 1) * kTile; x < cx * kTile; ++x) {
          const double w = view.wall(x, y);
          low = std::min(low, w);
          high = std::max(high, w);
        }
      }
      build.kind[cell(cx, cy)] = high == 0.0  ? Build::kFree
                                 : low == 1.0 ? Build::kWall
                                              : Build::kMixed;
    }
  }
}

bool SubpixelField::has_edge(const Build& build, int cx, int cy) const {
  const std::uint8_t kind = build.kind[cell(cx, cy)];
  if (kind == Build::kMixed) return true;
  // An edge along the cell's own border makes neighbours differ.
  for (int side = 0; side < 4; ++side) {
    const int nx = cx + (side == 0) - (side == 1), ny = cy + (side == 2) - (side == 3);
    if (nx < 0 || ny < 0 || nx >= columns_ || ny >= rows_) continue;
    if (build.kind[cell(nx, ny)] != kind) return true;
  }
  return false;
}

// The pieces of surface, and which cells become tiles.
void SubpixelField::find_surface(Build& build) const {
  build.tile.assign(build.kind.size(), 0);
  std::vector<SurfacePatch> found;
  std::vector<SurfaceEnd> ends;
  for (int cy = 0; cy < rows_; ++cy) {
    for (int cx = 0; cx < columns_; ++cx) {
      if (!has_edge(build, cx, cy)) continue;
      if (build.kind[cell(cx, cy)] == Build::kMixed) build.tile[cell(cx, cy)] = 1;
      find_patches(build.view, (cx - 1) * kTile, (cy - 1) * kTile, found, ends);
    }
  }
  build.explained = resolve_corners(build.view, ends, found);
  const auto mark = [&](const Vec2& p, double reach, std::uint8_t as) {
    for (int cy = std::max(to_cell(p.y() - reach), 0);
         cy <= std::min(to_cell(p.y() + reach), rows_ - 1); ++cy) {
      for (int cx = std::max(to_cell(p.x() - reach), 0);
           cx <= std::min(to_cell(p.x() + reach), columns_ - 1); ++cx) {
        build.tile[cell(cx, cy)] = std::max(build.tile[cell(cx, cy)], as);
      }
    }
  };
  for (const SurfacePatch& piece : found) {
    mark(piece.at(0.0), kReach + 1.0, 1);
    if (piece.delicate) mark(piece.at(0.0), kDelicate, 2);
  }
  sort_surface(found, build);
}

// The pieces by cell, in two passes.
void SubpixelField::sort_surface(const std::vector<SurfacePatch>& found, Build& build) const {
  const auto cell_of = [&](const SurfacePatch& piece) {
    const Vec2 p = piece.at(0.0);
    return cell(std::clamp(to_cell(p.x()), 0, columns_ - 1),
                std::clamp(to_cell(p.y()), 0, rows_ - 1));
  };
  build.first.assign(build.kind.size() + 1, 0);
  for (const SurfacePatch& piece : found) ++build.first[cell_of(piece) + 1];
  std::partial_sum(build.first.begin(), build.first.end(), build.first.begin());
  build.patches.resize(found.size());
  std::vector<std::uint32_t> next(build.first.begin(), build.first.end() - 1);
  for (const SurfacePatch& piece : found) build.patches[next[cell_of(piece)]++] = piece;
}

void SubpixelField::fill(const Build& build, int cx, int cy, bool fine,
                         std::int16_t* samples) const {
  Grid grid((cx - 1) * kTile, (cy - 1) * kTile, fine);
  grid.guess(build.view);
  for (int ny = std::max(cy - 1, 0); ny <= std::min(cy + 1, rows_ - 1); ++ny) {
    for (int nx = std::max(cx - 1, 0); nx <= std::min(cx + 1, columns_ - 1); ++nx) {
      for (std::size_t k = build.first[cell(nx, ny)]; k < build.first[cell(nx, ny) + 1]; ++k) {
        grid.take(build.patches[k]);
      }
    }
  }
  grid.keep_pixels(build.view);
  if (fine) stand_cores(build, cx, cy, grid.value.data());
  const auto keep = [&](double v) {
    return static_cast<std::int16_t>(std::lround(std::clamp(v, -grid.reach, grid.reach) / kUnit));
  };
  if (!fine) {
    std::transform(grid.value.begin(), grid.value.begin() + grid.n * grid.n, samples, keep);
    return;
  }
  for (int j = 0; j < kFine; ++j) {
    for (int i = 0; i < kFine; ++i) {
      const Vec2 p = grid.at(i + kAround, j + kAround);
      const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
      samples[j * kFine + i] = keep(
          build.explained.has(x, y) ? grid.value_at(i + kAround, j + kAround)
                                    : without_nooks(grid.value.data(), i + kAround, j + kAround));
    }
  }
}

// Thin walls stand wherever their core does, whatever their faces look like near a junction.
void SubpixelField::stand_cores(const Build& build, int cx, int cy, double* value) const {
  constexpr double kPitch = 0.25;
  constexpr double kEdge = (0.5 + kAround) * kPitch;
  const double x0 = (cx - 1) * kTile - kEdge, y0 = (cy - 1) * kTile - kEdge;
  std::vector<CoreSegment> cores;
  find_cores(build.view, build.explained, (cx - 1) * kTile, (cy - 1) * kTile, cores);
  for (const CoreSegment& core : cores) {
    const Vec2 low = core.a.cwiseMin(core.b) - Vec2(x0, y0),
               high = core.a.cwiseMax(core.b) - Vec2(x0, y0);
    const auto first = [](double at) {
      return std::max(static_cast<int>(std::ceil((at - kCoreReach) / kPitch)), 0);
    };
    const auto last = [](double at) {
      return std::min(static_cast<int>(std::floor((at + kCoreReach) / kPitch)), kWide - 1);
    };
    for (int j = first(low.y()); j <= last(high.y()); ++j) {
      for (int i = first(low.x()); i <= last(high.x()); ++i) {
        double& v = value[j * kWide + i];
        v = std::min(v, core.distance({x0 + i * kPitch, y0 + j * kPitch}));
      }
    }
  }
}

// Free cells learn how many rings of cells around them hold no tile. Chebyshev's distance, exact in
// two passes.
void SubpixelField::mark_rings() {
  const auto ring = [&](int cx, int cy) -> std::uint32_t {
    if (cx < 0 || cy < 0 || cx >= columns_ || cy >= rows_) return 0;
    const Cell c = cells_[cell(cx, cy)];
    return c.is_free() ? c.rings() : 0;
  };
  for (Cell& c : cells_) c = c.is_free() ? Cell::free(Cell::kMostRings) : c;
  const auto relax = [&](int cx, int cy, int way) {
    Cell& c = cells_[cell(cx, cy)];
    if (!c.is_free()) return;
    const std::uint32_t least = std::min(
        {ring(cx - way, cy), ring(cx - 1, cy - way), ring(cx, cy - way), ring(cx + 1, cy - way)});
    c = Cell::free(std::min(c.rings(), least + 1));
  };
  for (int cy = 0; cy < rows_; ++cy) {
    for (int cx = 0; cx < columns_; ++cx) relax(cx, cy, 1);
  }
  for (int cy = rows_ - 1; cy >= 0; --cy) {
    for (int cx = columns_ - 1; cx >= 0; --cx) relax(cx, cy, -1);
  }
}

SubpixelField::Probe SubpixelField::at(const Vec2& p) const noexcept {
  Probe out;
  // Cells by position; the ring around the map keeps a pixel beyond the border in range.
  const double x = p.x() + kTile, y = p.y() + kTile;
  if (!(x >= 0.0 && y >= 0.0 && x < columns_ * kTile && y < rows_ * kTile)) {
    out.distance = -kReach;
    return out;
  }
  const int cx = static_cast<int>(x) / kTile, cy = static_cast<int>(y) / kTile;
  const Cell c = cells_[cell(cx, cy)];
  if (!c.is_tile()) {
    out.distance = c.is_free() ? kReach + kTile * (static_cast<double>(c.rings()) - 1.0) : -kReach;
    return out;
  }
  out.fine = c.fine();
  const double scale = out.fine ? 4.0 : 1.0;
  const int stride = out.fine ? kFine : kCoarse;
  const double u = (x - cx * kTile) * scale, v = (y - cy * kTile) * scale;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  spread(&samples_[c.first() + static_cast<std::size_t>(j * stride + i)], stride, u - i - 0.5,
         v - j - 0.5, scale, out);
  return out;
}

std::size_t SubpixelField::memory() const noexcept {
  return sizeof(*this) + cells_.capacity() * sizeof(cells_[0]) +
         samples_.capacity() * sizeof(samples_[0]);
}

}  // namespace handrail
