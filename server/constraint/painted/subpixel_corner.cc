#include "server/constraint/painted/subpixel_corner.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace handrail {
namespace {

// Lengths in pixels. In brackets: the range in which the tests hold, see WALLS.md. Else derived.
constexpr double kFarthestCorner = 7.0;  // [5.6, any] along u from a surface's end to its corner
constexpr double kNearest = 0.1;         // [0, 0.3] a surface goes on at least
constexpr double kParallel = 0.08;       // [0.0264, 0.4] sine between surfaces that do not meet
constexpr double kRoughly = 0.3;         // [0.24, 0.45] ... if either is rough
constexpr double kHint = 0.3;            // [0.06, 0.375] coverage worth a closer look
constexpr double kAgree = 0.06;          // [0.003, 0.075] coverage as the corner has it
constexpr double kRefined = 0.5;         // [0.1, any] a surface is not moved or turned more
constexpr double kRough = 20.0;          // rough ends come last: above 2 kFarthestCorner
constexpr double kBeside = 1.0;          // [0.65, 1] pixels this near its surfaces are looked at
constexpr double kSame = 1.0;            // [0, 2] corners this near are one
constexpr double kGoesOn = 0.8;          // [0.72, any] a piece this near an end goes on there
constexpr double kAhead = 1.0;           // [0, any] looked at where none does, so far past the end
constexpr double kSkin = 0.3;            // [0, any] ... and so far inside the wall
constexpr int kCell = 8;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  return (p - a - std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

struct Corner {
  const SurfaceEnd* from[2];
  SurfaceEnd end[2];  // as the pixels refine them
  double u[2];        // where they meet, on each
  Vec2 at;
  bool inner;  // free space in the corner; else wall
  double far;  // from both ends
};

// The unit square's part on the positive side of both lines.
class Square {
 public:
  explicit Square(const Vec2& middle) {
    for (const Vec2& d : {Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(0.5, 0.5), Vec2(-0.5, 0.5)}) {
      p_[count_++] = middle + d;
    }
  }
  void cut(const Vec2& point, const Vec2& normal) {
    std::array<Vec2, 8> old = p_;
    const std::size_t n = count_;
    count_ = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 &a = old[i], &b = old[(i + 1) % n];
      const double da = (a - point).dot(normal), db = (b - point).dot(normal);
      if (da >= 0.0) p_[count_++] = a;
      if ((da >= 0.0) != (db >= 0.0)) p_[count_++] = a + da / (da - db) * (b - a);
    }
  }
  double area() const {
    double twice = 0.0;
    for (std::size_t i = 0; i < count_; ++i) twice += cross(p_[i], p_[(i + 1) % count_]);
    return 0.5 * twice;
  }

 private:
  std::array<Vec2, 8> p_;
  std::size_t count_ = 0;
};

// u of the surface's point nearest to `p`, as on its tangent at `u`.
double foot(const SurfacePatch& piece, double u, const Vec2& p) {
  const Vec2 way = piece.along(u);
  return u + (p - piece.at(u)).dot(way) / way.squaredNorm();
}

bool meet(const SurfaceEnd& a, const SurfaceEnd& b, Corner& out) {
  const double parallel = a.rough || b.rough ? kRoughly : kParallel;
  double ua = 0.0, ub = 0.0;
  for (int i = 0; i < 5; ++i) {
    const Vec2 pa = a.piece.at(ua), da = a.piece.along(ua), pb = b.piece.at(ub),
               db = b.piece.along(ub);
    const double sine = cross(da, db);
    if (!(std::abs(sine) > parallel * da.norm() * db.norm())) return false;
    ua += cross(pb - pa, db) / sine;
    ub += cross(pb - pa, da) / sine;
    if (!(std::abs(ua) < 2.0 * kFarthestCorner && std::abs(ub) < 2.0 * kFarthestCorner))
      return false;
  }
  if (!(a.way * ua > kNearest && b.way * ub > kNearest)) return false;
  if (a.way * ua > kFarthestCorner || b.way * ub > kFarthestCorner) return false;
  const double into_b = a.way * a.piece.along(ua).dot(b.piece.normal(ub));
  const double into_a = b.way * b.piece.along(ub).dot(a.piece.normal(ua));
  if (!(into_a * into_b > 0.0)) return false;
  out = {{nullptr, nullptr},
         {a, b},
         {ua, ub},
         a.piece.at(ua),
         into_b < 0.0,
         std::abs(ua) + std::abs(ub) + (a.rough ? kRough : 0.0) + (b.rough ? kRough : 0.0)};
  return true;
}

// Calls `look` with each pixel in the corner or beside its surfaces, until it says false.
template <typename Look>
bool each_pixel(const Corner& corner, Look&& look) {
  const Vec2 a = corner.end[0].piece.at(0.0), b = corner.end[1].piece.at(0.0), c = corner.at;
  const double turn = cross(a - c, b - c);
  const Vec2 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  for (int y = static_cast<int>(std::floor(low.y() - kBeside)); y <= high.y() + kBeside; ++y) {
    for (int x = static_cast<int>(std::floor(low.x() - kBeside)); x <= high.x() + kBeside; ++x) {
      const Vec2 p(x + 0.5, y + 0.5);
      const bool between = corner.inner && cross(a - c, p - c) * turn > 0.0 &&
                           cross(p - c, b - c) * turn > 0.0 && cross(b - a, p - a) * turn < 0.0;
      if (!between && distance_to_segment(p, a, c) > kBeside &&
          distance_to_segment(p, b, c) > kBeside) {
        continue;
      }
      if (!look(x, y)) return false;
    }
  }
  return true;
}

// What the corner makes of a pixel, 0 free to 1 wall.
double wall_of(const Corner& corner, int x, int y) {
  const Vec2 p(x + 0.5, y + 0.5);
  Square square(p);
  for (const SurfaceEnd& end : corner.end) {
    const double u = foot(end.piece, foot(end.piece, 0.0, p), p);
    square.cut(end.piece.at(u), (corner.inner ? 1.0 : -1.0) * end.piece.normal(u));
  }
  return corner.inner ? 1.0 - square.area() : square.area();
}

// Whether its pixels are as the corner has them.
bool agrees(const CoverageView& view, const Corner& corner, double within) {
  return each_pixel(corner, [&](int x, int y) {
    return std::abs(wall_of(corner, x, y) - view.wall(x, y)) <= within;
  });
}

// Shifts and turns both surfaces so that they explain the pixels best: two of Gauss's steps.
void refine(const CoverageView& view, Corner& corner) {
  constexpr double kStep = 1e-3;
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix4d normal = 1e-6 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    const auto moved = [&](int k, double by) {
      Corner out = corner;
      SurfacePatch& piece = out.end[k / 2].piece;
      (k % 2 == 0 ? piece.height : piece.slope) += by;
      return out;
    };
    const Corner shifted[4] = {moved(0, kStep), moved(1, kStep), moved(2, kStep), moved(3, kStep)};
    each_pixel(corner, [&](int x, int y) {
      const double here = wall_of(corner, x, y);
      Eigen::Vector4d slope;
      for (int k = 0; k < 4; ++k) slope[k] = (wall_of(shifted[k], x, y) - here) / kStep;
      normal += slope * slope.transpose();
      right += (view.wall(x, y) - here) * slope;
      return true;
    });
    const Eigen::Vector4d by = normal.ldlt().solve(right);
    if (!(by.cwiseAbs().maxCoeff() < kRefined)) return;
    Corner next;
    SurfaceEnd a = corner.end[0], b = corner.end[1];
    a.piece.height += by[0];
    a.piece.slope += by[1];
    b.piece.height += by[2];
    b.piece.slope += by[3];
    if (!meet(a, b, next)) return;
    next.from[0] = corner.from[0];
    next.from[1] = corner.from[1];
    corner = next;
  }
}

// Whether a piece is one of those between the corner and its surfaces' ends, `from` along u past
// one.
bool between(const SurfacePatch& piece, const Corner& corner, double from) {
  const Vec2 p = piece.at(0.0), n = piece.normal(0.0);
  const bool faces = std::max(n.dot(corner.end[0].piece.normal(0.0)),
                              n.dot(corner.end[1].piece.normal(0.0))) > 0.0;
  for (const SurfaceEnd& end : corner.end) {
    if (distance_to_segment(p, end.piece.at(0.0), corner.at) > kBeside) continue;
    if (faces && end.way * foot(end.piece, 0.0, p) > from) return true;
  }
  return false;
}

// The surface's pieces from its end to the corner.
void extend(const SurfaceEnd& end, double u, bool inner, std::vector<SurfacePatch>& out) {
  const std::int8_t past = inner ? -1 : 1;
  for (int k = 0; k - 0.5 < std::abs(u); ++k) {
    SurfacePatch piece = end.piece;
    piece.from = -0.5;
    piece.to = 0.5;
    piece.past_from = piece.past_to = 0;
    const double at = k * end.way;
    piece.middle += at;
    piece.height += (piece.slope + piece.bend * at) * at;
    piece.slope += 2.0 * piece.bend * at;
    piece.delicate = true;
    if (k + 0.5 >= std::abs(u)) {
      (end.way > 0.0 ? piece.to : piece.from) = u - at;
      (end.way > 0.0 ? piece.past_to : piece.past_from) = past;
    }
    out.push_back(piece);
  }
}

// Which 8 x 8 pixels a point is in, `dx` and `dy` such beside.
std::int64_t cell_of(const Vec2& p, int dx = 0, int dy = 0) {
  const auto cell = [](double v) { return static_cast<std::int64_t>(std::floor(v / kCell)); };
  return (cell(p.y()) + dy) * (std::int64_t{1} << 32) + cell(p.x()) + dx;
}

// Where a wall's surface ends with no piece going on, as at a thin wall's tip, free space is past
// the end unless the pixels there are wall.
void mark_loose_ends(const CoverageView& view, std::vector<SurfacePatch>& patches) {
  std::unordered_multimap<std::int64_t, const SurfacePatch*> near;
  for (const SurfacePatch& piece : patches) {
    if (piece.delicate) near.emplace(cell_of(piece.at(0.0)), &piece);
  }
  const auto goes_on = [&](const SurfacePatch& piece, const Vec2& end, const Vec2& out) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto [first, last] = near.equal_range(cell_of(end, dx, dy));
        for (auto it = first; it != last; ++it) {
          const Vec2 to = it->second->at(0.0) - end;
          if (it->second != &piece && to.norm() < kGoesOn && to.dot(out) > 0.0 &&
              it->second->normal(0.0).dot(piece.normal(0.0)) > 0.5) {
            return true;
          }
        }
      }
    }
    return false;
  };
  for (SurfacePatch& piece : patches) {
    if (!piece.delicate) continue;
    for (const double way : {-1.0, 1.0}) {
      const double u = way < 0.0 ? piece.from : piece.to;
      std::int8_t& past = way < 0.0 ? piece.past_from : piece.past_to;
      const Vec2 out = way * piece.along(u).normalized(), end = piece.at(u);
      if (past != 0 || goes_on(piece, end, out)) continue;
      const Vec2 there = end + kAhead * out - kSkin * piece.normal(u);
      const double wall = view.wall(static_cast<int>(std::floor(there.x())),
                                    static_cast<int>(std::floor(there.y())));
      if (wall < 0.5) past = 1;
    }
  }
}

// Where any two ends meet, the nearest first.
std::vector<Corner> corners_of(const std::vector<SurfaceEnd>& ends) {
  std::unordered_multimap<std::int64_t, const SurfaceEnd*> near;
  for (const SurfaceEnd& end : ends) near.emplace(cell_of(end.piece.at(0.0)), &end);
  std::vector<Corner> corners;
  for (const SurfaceEnd& end : ends) {
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        const auto [first, last] = near.equal_range(cell_of(end.piece.at(0.0), dx, dy));
        for (auto it = first; it != last; ++it) {
          Corner corner;
          if (!(it->second > &end) || !meet(end, *it->second, corner)) continue;
          corner.from[0] = &end;
          corner.from[1] = it->second;
          corners.push_back(corner);
        }
      }
    }
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.far < b.far; });
  return corners;
}

// Corners that the pixels have shown, by where they are.
class KnownCorners {
 public:
  // Must stay where it is.
  void add(const Corner& corner) { by_cell_.emplace(cell_of(corner.at), &corner); }

  // Whether `test` is true for one of those around `p`.
  template <typename Test>
  bool any(const Vec2& p, Test&& test) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto [first, last] = by_cell_.equal_range(cell_of(p, dx, dy));
        for (auto it = first; it != last; ++it) {
          if (test(*it->second)) return true;
        }
      }
    }
    return false;
  }

  // That one is known already, or comes of one that is.
  bool explain(const Corner& corner) const {
    const auto same = [&](const Corner& other) {
      return (other.at - corner.at).norm() < kSame || other.from[0] == corner.from[0] ||
             other.from[0] == corner.from[1] || other.from[1] == corner.from[0] ||
             other.from[1] == corner.from[1];
    };
    // A rough end on the way to a corner is of the corner's making.
    const auto made = [&](const SurfaceEnd* end) {
      return end->rough && any(end->piece.at(0.0), [&](const Corner& other) {
               return between(end->piece, other, 0.25);
             });
    };
    return made(corner.from[0]) || made(corner.from[1]) || any(corner.at, same);
  }

 private:
  std::unordered_multimap<std::int64_t, const Corner*> by_cell_;
};

}  // namespace

PixelSet resolve_corners(const CoverageView& view, const std::vector<SurfaceEnd>& ends,
                         std::vector<SurfacePatch>& patches) {
  std::vector<Corner> corners = corners_of(ends);
  KnownCorners known;
  std::vector<SurfacePatch> pieces;
  PixelSet explained;
  for (Corner& corner : corners) {
    if (known.explain(corner) || !agrees(view, corner, kHint)) continue;
    refine(view, corner);
    if (!agrees(view, corner, kAgree)) continue;
    known.add(corner);
    for (std::size_t i = 0; i < 2; ++i) extend(corner.end[i], corner.u[i], corner.inner, pieces);
    if (corner.inner) each_pixel(corner, [&](int x, int y) { return explained.add(x, y), true; });
  }
  std::erase_if(patches, [&](const SurfacePatch& piece) {
    return known.any(piece.at(0.0),
                     [&](const Corner& corner) { return between(piece, corner, -0.25); });
  });
  patches.insert(patches.end(), pieces.begin(), pieces.end());
  mark_loose_ends(view, patches);
  return explained;
}

}  // namespace handrail
