#include "server/kinematics/box_solve.h"

#include <gtest/gtest.h>

#include <random>

namespace handrail {
namespace {

using Vector = Eigen::Matrix<double, 4, 1>;
using Matrix = Eigen::Matrix<double, 4, 4>;

// Nothing in the box near the answer is better.
TEST(SolveInBox, IsTheLeastInTheBox) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> some;
  int at_limit = 0;
  for (int run = 0; run < 300; ++run) {
    const Matrix A = Matrix::NullaryExpr([&] { return some(random); });
    const Matrix H = A.transpose() * A + 0.1 * Matrix::Identity();
    const Vector g = Vector::NullaryExpr([&] { return 2.0 * some(random); });
    const Vector low = Vector::Constant(-0.5), high = Vector::Constant(0.4);
    const Vector d = solve_in_box<4>(H, g, low, high, Vector::Ones());
    const auto cost = [&](const Vector& x) { return 0.5 * x.dot(H * x) - g.dot(x); };
    ASSERT_GE((d - low).minCoeff(), 0.0);
    ASSERT_GE((high - d).minCoeff(), 0.0);
    at_limit += (d.array() == high.array()).any() || (d.array() == low.array()).any();
    for (int i = 0; i < 4; ++i) {
      for (const double step : {-1e-4, 1e-4}) {
        Vector x = d;
        x[i] = std::clamp(x[i] + step, low[i], high[i]);
        ASSERT_GE(cost(x), cost(d) - 1e-9) << run;
      }
    }
  }
  EXPECT_GT(at_limit, 100);
}

}  // namespace
}  // namespace handrail
