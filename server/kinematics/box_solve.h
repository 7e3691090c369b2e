// Least squares in a box: a handful of unknowns, each between two limits.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

namespace handrail {

// The d that minimises d'Hd/2 - g'd with low <= d <= high: the unknown furthest outside, in units
// of `size` > 0, is put on its limit, again and again, and one that would rather come back inside
// is let go once. H symmetric and positive definite. Real-time safe, at most 2 N + 1 solutions of N
// equations; where that does not do, the best of them.
template <int N>
Eigen::Matrix<double, N, 1> solve_in_box(const Eigen::Matrix<double, N, N>& H,
                                         const Eigen::Matrix<double, N, 1>& g,
                                         const Eigen::Matrix<double, N, 1>& low,
                                         const Eigen::Matrix<double, N, 1>& high,
                                         const Eigen::Matrix<double, N, 1>& size) noexcept {
  using Vector = Eigen::Matrix<double, N, 1>;
  std::array<int, N> end{};  // -1, 1: held on its low, high limit
  std::array<bool, N> let_go{};
  Vector d = Vector::Zero();
  for (int round = 0; round <= 2 * N; ++round) {
    Eigen::Matrix<double, N, N> A = H;
    Vector r = g;
    for (int i = 0; i < N; ++i) {
      if (end[static_cast<std::size_t>(i)] == 0) continue;
      r -= H.col(i) * d[i];
      A.row(i).setZero();
      A.col(i).setZero();
      A(i, i) = 1.0;
    }
    for (int i = 0; i < N; ++i) {
      if (end[static_cast<std::size_t>(i)] != 0) r[i] = d[i];
    }
    d = A.ldlt().solve(r);
    int worst = -1;
    double most = 1e-14;
    for (int i = 0; i < N; ++i) {
      if (end[static_cast<std::size_t>(i)] != 0) continue;
      const double over = std::max(d[i] - high[i], low[i] - d[i]) / size[i];
      if (over > most) {
        most = over;
        worst = i;
      }
    }
    if (worst >= 0) {
      end[static_cast<std::size_t>(worst)] = d[worst] > high[worst] ? 1 : -1;
      d[worst] = std::clamp(d[worst], low[worst], high[worst]);
      continue;
    }
    const Vector slope = H * d - g;
    most = 0.0;
    for (int i = 0; i < N; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double inward = end[k] * slope[i];
      if (end[k] != 0 && !let_go[k] && inward > most) {
        most = inward;
        worst = i;
      }
    }
    if (worst < 0) break;
    end[static_cast<std::size_t>(worst)] = 0;
    let_go[static_cast<std::size_t>(worst)] = true;
  }
  return d.cwiseMax(low).cwiseMin(high);
}

}  // namespace handrail
