// The arm's kinematics beside Orocos KDL's recursive forward solver on the same seeded joints.
#include <array>

#include "tests/bench/percentile.h"
#include "tests/support/arm_samples.h"
#include "tests/support/kdl_arm.h"

namespace handrail::bench {
namespace {

// Joints in range, their poses, and a seed as far away as one controller period allows.
struct Cases {
  static constexpr std::size_t kCount = 1024;
  std::array<JointVector, kCount> q;
  std::array<JointVector, kCount> seed;
  std::array<KDL::JntArray, kCount> kdl_q;
  std::array<Pose, kCount> X_ST;

  Cases() {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    for (std::size_t i = 0; i < kCount; ++i) {
      q[i] = test::random_joints(random);
      seed[i] = q[i];
      for (int j = 0; j < kJoints; ++j) {
        seed[i][j] += share(random) * 0.0071 * rv2a_limits().max_speed[j];
      }
      kdl_q[i] = KDL::JntArray(kJoints);
      kdl_q[i].data = q[i];
      X_ST[i] = forward({}, q[i]);
    }
  }
};

const Cases& cases() {
  static const Cases all;
  return all;
}

// Each functor takes the next case at every call and returns its answer.
struct InverseAll {
  std::size_t i = 0;
  InverseSolutions found;
  const InverseSolutions* operator()() {
    i = (i + 1) % Cases::kCount;
    inverse_all({}, cases().X_ST[i], cases().seed[i], found);
    benchmark::DoNotOptimize(found);
    return &found;
  }
};

struct InverseNear {
  std::size_t i = 0;
  JointVector q;
  InverseStatus operator()() {
    i = (i + 1) % Cases::kCount;
    const InverseStatus status = inverse_near({}, cases().X_ST[i], cases().seed[i], q);
    benchmark::DoNotOptimize(q);
    return status;
  }
};

struct Forward {
  std::size_t i = 0;
  Pose operator()() {
    i = (i + 1) % Cases::kCount;
    return forward({}, cases().q[i]);
  }
};

struct KdlForward {
  std::size_t i = 0;
  KDL::Chain chain = test::kdl_arm();
  KDL::ChainFkSolverPos_recursive solver{chain};
  KDL::Frame tip;
  int operator()() {
    i = (i + 1) % Cases::kCount;
    const int status = solver.JntToCart(cases().kdl_q[i], tip);
    benchmark::DoNotOptimize(tip);
    return status;
  }
};

constexpr double kInverseAllTarget = 700.0;  // [ns]
// The same target on the machine where KDL's forward took 595 ns.
constexpr double kInverseAllToKdl = 0.7 / 0.595;

void inverse_all_bench(benchmark::State& state) {
  run(state, "inverse_all", 1, kInverseAllTarget, InverseAll());
}
void inverse_near_bench(benchmark::State& state) {
  run(state, "inverse_near", 1, 0.0, InverseNear());
}
void forward_bench(benchmark::State& state) { run(state, "forward", 10, 0.0, Forward()); }
void kdl_forward_bench(benchmark::State& state) { run(state, "kdl_forward", 1, 0.0, KdlForward()); }

// All four in turn, so that a change of the machine's speed meets them alike: the ratios come from
// here.
void interleaved_bench(benchmark::State& state) {
  InverseAll all;
  InverseNear near;
  Forward ours;
  KdlForward kdl;
  Samples all_samples, near_samples, ours_samples(10), kdl_samples;
  for ([[maybe_unused]] auto _ : state) {
    all_samples.time(all);
    kdl_samples.time(kdl);
    near_samples.time(near);
    ours_samples.time(ours);
  }
  record(state, "interleaved/inverse_near", near_samples);
  record(state, "interleaved/forward", ours_samples);
  record(state, "interleaved/kdl_forward", kdl_samples);
  record(state, "interleaved/inverse_all", all_samples, kInverseAllTarget);
  state.counters["to_kdl_forward"] = all_samples.summary().median / kdl_samples.summary().median;
  state.SetLabel("counters of inverse_all among the others");
}

BENCHMARK(inverse_all_bench)->Name("inverse_all");
BENCHMARK(inverse_near_bench)->Name("inverse_near");
BENCHMARK(forward_bench)->Name("forward");
BENCHMARK(kdl_forward_bench)->Name("kdl_forward");
BENCHMARK(interleaved_bench)->Name("kinematics_interleaved");

[[maybe_unused]] const bool compared = [] {
  compare("interleaved/inverse_all", "interleaved/kdl_forward", kInverseAllToKdl);
  compare("interleaved/forward", "interleaved/kdl_forward", 1.0);
  return true;
}();

}  // namespace
}  // namespace handrail::bench
