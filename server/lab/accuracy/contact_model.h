// A hand against an elastic wall in one dimension, solved in closed form: the reference for
// integrators and rates.
#pragma once

#include <vector>

namespace handrail {

// m x'' = -b x' - k (x - rest) - (x > 0 ? wall x : 0).
struct ContactModel {
  double mass = 1.3;       // m > 0 [kg]
  double damping = 16.0;   // b >= 0 [N s/m]
  double stiffness = 350;  // k > 0 [N/m]
  double rest = 0.0;       // where the hand means to be [m]
  double wall = 5000.0;    // >= 0 [N/m]

  double force(double x, double v) const {
    return -damping * v - stiffness * (x - rest) - (x > 0.0 ? wall * x : 0.0);
  }
};

struct Motion1 {
  double x = 0.0;  // [m]
  double v = 0.0;  // [m/s]
};

// m x'' = -b x' - k (x - rest) from `from` after `t` >= 0 seconds, exact to rounding.
Motion1 spring_motion(double mass, double damping, double stiffness, double rest,
                      const Motion1& from, double t);

// The model's motion, pieced together where it meets and leaves the wall. The places are found to
// 1e-15 s; a touch shorter than a 64th of the faster period is taken for none.
class ExactContact {
 public:
  ExactContact(const ContactModel& model, const Motion1& from, double duration);
  // 0 <= t <= duration [s].
  Motion1 at(double t) const;

 private:
  struct Piece {
    double start = 0.0;
    Motion1 from;
    bool touching = false;
  };
  Motion1 within(const Piece& piece, double t) const;

  ContactModel model_;
  std::vector<Piece> pieces_;
};

}  // namespace handrail
