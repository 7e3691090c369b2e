#include "server/constraint/painted/subpixel_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace handrail {
namespace {

// In brackets: the range in which the tests hold, see WALLS.md. Else derived.
constexpr int kTile = 8;
constexpr int kWindowMargin = 8;  // of the window around the tile: kThin sqrt(2), rounded up
constexpr int kWindow = kTile + 2 * kWindowMargin;
constexpr int kColumnsBeside = 3;  // of the tile: 1 to the next, 2 for its five heights
constexpr int kColumns = kTile + 2 * kColumnsBeside;
constexpr double kProminence = 0.3;  // [0.195, 0.45] coverage must change by this from free to wall
constexpr int kShort = 3;            // [3, any] pixels a crossing takes in a column not along it
constexpr double kMatch = 1.5;       // [1.5, 1.65] heights of one surface in adjacent columns
constexpr double kAlong = 0.7;       // [0.63, 0.875] rise of coverage in a column, of that across
constexpr double kSteepest = 1.25;   // [1.12, 1.25] slopes beyond are for the other axis
constexpr double kSharpest = 0.5;    // [0.4, any] bends beyond are corners
constexpr double kKink = 0.05;       // [0.04, 0.1] ... and beyond these may be beside one
constexpr double kSmoother = 0.3;    // [0, 0.45] which shows in how much straighter one side is
constexpr double kSmooth = 0.02;  // [0.02, 0.03] bends side by side, of one surface, differ by less
constexpr double kSmoothBend = 0.2;     // [0.2, 0.6] ... and by this much of the bend more
constexpr double kStraightest = 0.004;  // bends below are of 8 bits: 3 (8/14) (0.5/255)
constexpr double kRoughBend = 0.2;      // [0.13, any] a short surface beside corners looks as bent
constexpr double kFirm = 1.8;   // [0, 1.8] a pixel of thinner walls and gaps holds both faces
constexpr double kThin = 5.0;   // [3.25, 15] walls and gaps below need fine samples
constexpr double kTight = 0.1;  // [0.08, any] so do curves of less than 10 pixels

using Column = std::array<double, kWindow>;
using Window = std::array<Column, kWindow>;

// Where a column passes from free to wall or back.
struct Crossing {
  double at = 0.0;
  double side = 1.0;  // +1: free above
  double room = 0.0;  // to the nearer of the crossings before and after
  bool exact = true;  // the column is all free on one side of it and all wall on the other
};

struct Crossings {
  std::array<Crossing, kWindow> items;
  std::size_t count = 0;
};

// Alternating least and greatest coverage along the column, flutter below kProminence left out.
std::size_t extremes_of(const Column& w, std::array<int, kWindow>& extremes) {
  std::size_t count = 0;
  int low = 0, high = 0, direction = 0;
  for (int k = 1; k < kWindow; ++k) {
    const auto at = [&](int i) { return w[static_cast<std::size_t>(i)]; };
    if (direction >= 0 && at(k) > at(high)) high = k;
    if (direction <= 0 && at(k) < at(low)) low = k;
    if (direction <= 0 && at(k) - at(low) >= kProminence) {
      extremes[count++] = low;
      direction = 1;
      high = k;
    } else if (direction >= 0 && at(high) - at(k) >= kProminence) {
      extremes[count++] = high;
      direction = -1;
      low = k;
    }
  }
  if (direction != 0) extremes[count++] = direction > 0 ? high : low;
  return count;
}

// The faces of the wall (or, with `gap`, of the free space) between the columns' extremes: half its
// extent to either side of its centroid.
std::pair<double, double> faces(const Column& w, int from, int to, bool gap) {
  double sum = 0.0, moment = 0.0;
  for (int k = from; k <= to; ++k) {
    const double share =
        gap ? 1.0 - w[static_cast<std::size_t>(k)] : w[static_cast<std::size_t>(k)];
    sum += share;
    moment += share * (k + 0.5);
  }
  const double centre = moment / sum;
  return {centre - 0.5 * sum, centre + 0.5 * sum};
}

// Pixels the coverage takes from one extreme to the next.
int length(const Column& w, int from, int to) {
  const double a = w[static_cast<std::size_t>(from)], b = w[static_cast<std::size_t>(to)];
  int between = 0;
  for (int k = from + 1; k < to; ++k) {
    const double v = w[static_cast<std::size_t>(k)];
    between += std::min(std::abs(v - a), std::abs(v - b)) > 1.0 - kFull;
  }
  return between + 1;
}

// The crossing between the extremes i and i + 1 of `count`.
Crossing crossing_at(const Column& w, const std::array<int, kWindow>& extremes, std::size_t count,
                     std::size_t i) {
  const int a = extremes[i], b = extremes[i + 1];
  const bool rising = w[static_cast<std::size_t>(b)] > w[static_cast<std::size_t>(a)];
  Crossing c;
  c.side = rising ? -1.0 : 1.0;
  // What the extreme pixel at `e` has of the opposite, and how far the crossing beyond it runs.
  const auto lack = [&](std::size_t e, bool of_wall) {
    const double v = w[static_cast<std::size_t>(extremes[e])];
    const double amount = of_wall ? 1.0 - v : v;
    return amount > 1.0 - kFull ? amount : 0.0;
  };
  const double lack_before = i > 0 ? lack(i, !rising) : 0.0;
  const double lack_after = i + 2 < count ? lack(i + 1, rising) : 0.0;
  const int own = length(w, a, b);
  const int before = lack_before > 0.0 ? length(w, extremes[i - 1], a) : 0;
  const int after = lack_after > 0.0 ? length(w, b, extremes[i + 2]) : 0;
  c.exact = !(lack_before > 0.0) && !(lack_after > 0.0);
  if (lack_after > 0.0 && own <= kShort && after <= kShort) {
    c.at = faces(w, a, extremes[i + 2], !rising).first;
  } else if (lack_before > 0.0 && own <= kShort && before <= kShort) {
    c.at = faces(w, extremes[i - 1], b, rising).second;
  } else {
    // Where one crossing is short and the other a slanting edge, the lack is the edge's.
    double sum = 0.0;
    for (int k = a; k <= b; ++k) sum += w[static_cast<std::size_t>(k)];
    if (own < before) sum -= rising ? lack_before : -lack_before;
    if (own < after) sum += rising ? lack_after : -lack_after;
    c.at = rising ? b + 1.0 - sum : a + sum;
  }
  return c;
}

void find_crossings(const Column& w, Crossings& out) {
  std::array<int, kWindow> extremes;
  const std::size_t count = extremes_of(w, extremes);
  out.count = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    out.items[out.count++] = crossing_at(w, extremes, count, i);
  }
  for (std::size_t i = 0; i < out.count; ++i) {
    const double before = i > 0 ? out.items[i].at - out.items[i - 1].at : kWindow;
    const double after = i + 1 < out.count ? out.items[i + 1].at - out.items[i].at : kWindow;
    out.items[i].room = std::min(before, after);
  }
}

// The crossing of the same surface in the next column, or nothing.
const Crossing* match(const Crossings& column, const Crossing& c) {
  const Crossing* best = nullptr;
  for (std::size_t i = 0; i < column.count; ++i) {
    const Crossing& other = column.items[i];
    if (other.side != c.side || std::abs(other.at - c.at) > kMatch) continue;
    if (best == nullptr || std::abs(other.at - c.at) < std::abs(best->at - c.at)) best = &other;
  }
  return best;
}

// Whether coverage changes along the columns rather than across them there.
bool along(const Window& w, std::size_t u, std::size_t v) {
  double du = 0.0, dv = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = k == 1 ? 2.0 : 1.0;
    du += weight * (w[u + 1][v + k - 1] - w[u - 1][v + k - 1]);
    dv += weight * (w[u + k - 1][v + 1] - w[u + k - 1][v - 1]);
  }
  return std::abs(dv) >= kAlong * std::abs(du);
}

// The surface through `c` and its neighbours, from `columns` on; `at`: the column of `c`.
SurfacePatch patch_of(const std::array<Crossings, kColumns>& columns, std::size_t at,
                      const Crossing& c) {
  SurfacePatch p;
  const Crossing* before = match(columns[at - 1], c);
  const Crossing* after = match(columns[at + 1], c);
  if (before != nullptr && after != nullptr) {
    p.slope = 0.5 * (after->at - before->at);
    p.bend = 0.5 * (after->at + before->at) - c.at;
    // Beside a corner the surface goes on as it came, not toward the corner's far side.
    double least = kSmoother * std::abs(p.bend);
    for (const bool back : {true, false}) {
      const Crossing* near = back ? before : after;
      const Crossing* far = match(columns[back ? at - 2 : at + 2], *near);
      if (far == nullptr || !(std::abs(p.bend) > kKink)) continue;
      const double bend = 0.5 * (c.at + far->at) - near->at;
      if (!(std::abs(bend) < least)) continue;
      least = std::abs(bend);
      p.slope = (back ? 1.0 : -1.0) * (c.at - near->at + bend);
      p.bend = bend;
    }
    p.bend = std::clamp(p.bend, -kSharpest, kSharpest);
  } else if (after != nullptr) {
    p.slope = after->at - c.at;
  } else if (before != nullptr) {
    p.slope = c.at - before->at;
  }
  // Where the surface ends, it does so somewhere in the column: half of it is the best guess.
  if (before == nullptr) p.from = 0.0;
  if (after == nullptr) p.to = 0.0;
  p.height = c.at - p.bend / 12.0;  // the column's mean is not its middle's
  p.side = c.side;
  const double stretch = 1.0 / std::sqrt(1.0 + p.slope * p.slope);
  const bool ends = before == nullptr || after == nullptr;
  p.delicate = ends || c.room * stretch < kThin ||
               std::abs(after->at + before->at - 2.0 * c.at) * stretch * stretch * stretch > kTight;
  return p;
}

// Heights of the surface through `c` in the two columns to either side, before first; false where
// one is missing or not exact.
bool heights_around(const std::array<Crossings, kColumns>& columns, std::size_t at,
                    const Crossing& c, std::array<double, 5>& out) {
  if (at < 2 || at + 2 >= kColumns || !c.exact) return false;
  out[2] = c.at;
  for (const int way : {-1, 1}) {
    const Crossing* last = &c;
    for (int by = 1; by <= 2; ++by) {
      const int column = static_cast<int>(at) + way * by;
      last = match(columns[static_cast<std::size_t>(column)], *last);
      if (last == nullptr || !last->exact) return false;
      out[static_cast<std::size_t>(2 + way * by)] = last->at;
    }
  }
  return true;
}

// Whether the five columns around are of one smooth surface.
bool smooth(const std::array<Crossings, kColumns>& columns, std::size_t at, const Crossing& c) {
  std::array<double, 5> h;
  if (!heights_around(columns, at, c, h)) return false;
  const double bend = h[1] - 2.0 * h[2] + h[3];
  const double most = kSmooth + kSmoothBend * std::abs(bend);
  return std::abs(h[0] - 2.0 * h[1] + h[2] - bend) < most &&
         std::abs(h[2] - 2.0 * h[3] + h[4] - bend) < most;
}

// Whether the surface through `c` ends or turns in the next two columns that way.
bool turns(const std::array<Crossings, kColumns>& columns, std::size_t at, const Crossing& c,
           int way) {
  const auto column = [&](int by) -> const Crossings& {
    return columns[static_cast<std::size_t>(static_cast<int>(at) + way * by)];
  };
  const Crossing* next = match(column(1), c);
  const Crossing* after = next != nullptr ? match(column(2), *next) : nullptr;
  return after == nullptr || std::abs(c.at - 2.0 * next->at + after->at) > kKink;
}

// Appends where the smooth surface through `c` ends before or after its column. `piece`: its patch.
void find_ends(const std::array<Crossings, kColumns>& columns, std::size_t at, const Crossing& c,
               SurfacePatch piece, std::vector<SurfaceEnd>& out) {
  if (c.room < kFirm * std::sqrt(1.0 + piece.slope * piece.slope)) return;
  if (!smooth(columns, at, c)) {
    // A surface too short for that is as good as straight.
    if (std::abs(piece.bend) > kRoughBend) return;
    piece.bend = 0.0;
    for (const int way : {-1, 1}) {
      if (turns(columns, at, c, way)) out.push_back({piece, 1.0 * way, true});
    }
    return;
  }
  std::array<double, 5> h;
  heights_around(columns, at, c, h);
  // The parabola nearest to the five means of columns; straight where it could be.
  const double base = piece.height + piece.bend / 12.0 - c.at;
  piece.slope = (-2.0 * h[0] - h[1] + h[3] + 2.0 * h[4]) / 10.0;
  piece.bend = (2.0 * h[0] - h[1] - 2.0 * h[2] - h[3] + 2.0 * h[4]) / 14.0;
  double height = (-3.0 * h[0] + 12.0 * h[1] + 17.0 * h[2] + 12.0 * h[3] - 3.0 * h[4]) / 35.0;
  if (std::abs(piece.bend) < kStraightest) {
    piece.bend = 0.0;
    height = (h[0] + h[1] + h[2] + h[3] + h[4]) / 5.0;
  }
  piece.height = base + height - piece.bend / 12.0;
  for (const int way : {-1, 1}) {
    const std::size_t next = static_cast<std::size_t>(static_cast<int>(at) + way);
    if (!smooth(columns, next, *match(columns[next], c))) out.push_back({piece, 1.0 * way, false});
  }
}

// Where the column is not exact but some on either side are: the polynomial through the nearest two
// of each side, or as many as there are.
void mend(std::array<Crossings, kColumns>& columns, std::size_t u) {
  for (std::size_t i = 0; i < columns[u].count; ++i) {
    Crossing& c = columns[u].items[i];
    if (c.exact) continue;
    std::array<std::pair<double, double>, 4> known;  // column from here, height
    std::size_t count = 0, sides = 0;
    for (const int way : {-1, 1}) {
      const Crossing* last = &c;
      const std::size_t before = count;
      for (int by = 1; by <= 2; ++by) {
        const int next = static_cast<int>(u) + way * by;
        if (next < 0 || next >= kColumns) break;
        last = match(columns[static_cast<std::size_t>(next)], *last);
        if (last == nullptr) break;
        if (last->exact) known[count++] = {way * by, last->at};
      }
      sides += count > before;
    }
    if (sides < 2) continue;
    double height = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      double weight = 1.0;
      for (std::size_t other = 0; other < count; ++other) {
        if (other != k) weight *= known[other].first / (known[other].first - known[k].first);
      }
      height += weight * known[k].second;
    }
    c.at = height;
  }
}

void find_along(const Window& w, int x, int y, bool across, std::vector<SurfacePatch>& out,
                std::vector<SurfaceEnd>& ends) {
  std::array<Crossings, kColumns> columns;
  for (std::size_t u = 0; u < kColumns; ++u)
    find_crossings(w[u + kWindowMargin - kColumnsBeside], columns[u]);
  for (std::size_t u = 1; u + 1 < kColumns; ++u) mend(columns, u);
  for (std::size_t u = kColumnsBeside; u < kColumnsBeside + kTile; ++u) {
    for (std::size_t i = 0; i < columns[u].count; ++i) {
      const Crossing& c = columns[u].items[i];
      if (c.at < kWindowMargin || c.at >= kWindowMargin + kTile) continue;
      if (!along(w, u + kWindowMargin - kColumnsBeside, static_cast<std::size_t>(c.at))) continue;
      SurfacePatch p = patch_of(columns, u, c);
      if (std::abs(p.slope) > kSteepest) continue;
      p.across = across;
      p.middle = (across ? y : x) + static_cast<double>(u - kColumnsBeside) + 0.5;
      p.height += (across ? x : y) - kWindowMargin;
      out.push_back(p);
      find_ends(columns, u, c, p, ends);
    }
  }
}

}  // namespace

SurfacePatch::Distance SurfacePatch::distance(double x, double y) const noexcept {
  const double u = (across ? y : x) - middle, v = (across ? x : y) - height;
  // The foot on the parabola, by two of Newton's steps from the foot on its tangent.
  double f = std::clamp((u + slope * v) / (1.0 + slope * slope), from, to);
  for (int i = 0; i < 2; ++i) {
    const double rise = slope + 2.0 * bend * f;
    const double off = v - (slope + bend * f) * f;
    const double grown = std::max(1.0 + rise * rise - 2.0 * bend * off, 0.25);
    f = std::clamp(f - ((f - u) - off * rise) / grown, from, to);
  }
  const double rise = slope + 2.0 * bend * f;
  const double off = v - (slope + bend * f) * f;
  const double stretch = 1.0 / std::sqrt(1.0 + rise * rise);
  const double aside = u - f;
  const double d = std::sqrt(aside * aside + off * off);
  const double straight = (off - rise * aside) * stretch;
  double value = side * std::copysign(d, straight);
  const double past = aside + off * rise;
  if (f == to && past > 0.0 && past_to != 0) value = past_to * d;
  if (f == from && past < 0.0 && past_from != 0) value = past_from * d;
  const double curve = std::clamp(-2.0 * side * bend * stretch * stretch * stretch, -0.3, 0.3);
  return {value, d + 0.1 * (d - std::abs(straight)), curve / std::max(1.0 + curve * value, 0.3)};
}

void find_patches(const CoverageView& view, int x, int y, std::vector<SurfacePatch>& out,
                  std::vector<SurfaceEnd>& ends) {
  Window columns, rows;  // [u][v]
  for (std::size_t v = 0; v < kWindow; ++v) {
    for (std::size_t u = 0; u < kWindow; ++u) {
      const double w = view.wall(x - kWindowMargin + static_cast<int>(u),
                                 y - kWindowMargin + static_cast<int>(v));
      columns[u][v] = w;
      rows[v][u] = w;
    }
  }
  find_along(columns, x, y, false, out, ends);
  find_along(rows, x, y, true, out, ends);
}

}  // namespace handrail
