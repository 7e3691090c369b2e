#include "server/lab/figure/geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace handrail::figure {
namespace {

constexpr std::size_t kChunk = 2048;

bool is_finite(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

double distance(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double along =
      square > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

// Marks what to keep strictly between first and last.
void keep_between(const std::vector<Point>& points, std::size_t first, std::size_t last,
                  double tolerance, std::vector<bool>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> open = {{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    std::size_t farthest = a;
    double most = tolerance;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double d = distance(points[i], points[a], points[b]);
      if (d > most) {
        most = d;
        farthest = i;
      }
    }
    if (farthest == a) continue;
    kept[farthest] = true;
    open.push_back({a, farthest});
    open.push_back({farthest, b});
  }
}

// Narrows [from, to] to where start + t step is on the inner side: at least `low`, at most `high`.
bool narrow(double start, double step, double low, double high, double& from, double& to) {
  if (step == 0.0) return start >= low && start <= high;
  const double a = (low - start) / step, b = (high - start) / step;
  from = std::max(from, std::min(a, b));
  to = std::min(to, std::max(a, b));
  return from <= to;
}

// Source: Liang and Barsky 1984.
std::optional<std::pair<Point, Point>> clip(const Point& a, const Point& b, const Rect& frame) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  double from = 0.0, to = 1.0;
  if (!narrow(a.x, dx, frame.left, frame.right(), from, to)) return std::nullopt;
  if (!narrow(a.y, dy, frame.top, frame.bottom(), from, to)) return std::nullopt;
  const auto at = [&](double t) {
    return Point{std::clamp(a.x + t * dx, frame.left, frame.right()),
                 std::clamp(a.y + t * dy, frame.top, frame.bottom())};
  };
  return std::pair{from == 0.0 ? a : at(from), to == 1.0 ? b : at(to)};
}

}  // namespace

std::vector<Point> thin(const std::vector<Point>& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  for (std::size_t first = 0; first + 1 < points.size(); first += kChunk) {
    const std::size_t last = std::min(first + kChunk, points.size() - 1);
    kept[last] = true;
    keep_between(points, first, last, tolerance, kept);
  }
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i]) out.push_back(points[i]);
  }
  return out;
}

std::vector<std::vector<Point>> visible_runs(const std::vector<Point>& points, const Rect& frame) {
  std::vector<std::vector<Point>> runs;
  bool joined = false;  // the last run ends at the point before this one
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool before = i > 0 && is_finite(points[i - 1]);
    const bool after = i + 1 < points.size() && is_finite(points[i + 1]);
    const bool here = is_finite(points[i]);
    if (here && !before && !after && frame.contains(points[i])) {
      runs.push_back({points[i], points[i]});
    }
    const auto part = here && before ? clip(points[i - 1], points[i], frame) : std::nullopt;
    if (part) {
      if (!joined || !(runs.back().back() == part->first)) runs.push_back({part->first});
      runs.back().push_back(part->second);
    }
    joined = part.has_value();
  }
  return runs;
}

}  // namespace handrail::figure
