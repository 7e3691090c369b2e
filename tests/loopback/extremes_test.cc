// Every order at the ends of what its fields can say: refused, or done, and no side in fault.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

const double kExtremes[] = {0.0,
                            -1.0,
                            1e-308,
                            0.999,
                            1e3,
                            5773.6,
                            9999.999,
                            1e4,
                            -1e4,
                            1e300,
                            -1e300,
                            1e308,
                            std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()};
// Nearly all that a frame holds.
constexpr std::size_t kLongest = 65'000;

using Numbers = google::protobuf::RepeatedField<double>;

class ExtremesTest : public WholeCell {
 protected:
  void SetUp() override {
    WholeCell::SetUp();
    order("engage: true");
  }

  // Its answer is one that a person can read, and both sides go on.
  void try_order(const pb::Request& request) {
    ++tried_;
    const std::string what = request.ShortDebugString().substr(0, 300);
    const auto reply = client.call(request, kPatience);
    ASSERT_TRUE(reply) << what << ": " << reply.message();
    if (!reply->done()) {
      ++refused_;
      EXPECT_NE(reply->reason(), "") << what;
      EXPECT_LT(reply->reason().size(), 1000u) << what;
    }
    const pb::Status s = status();
    ASSERT_NE(s.state(), "fault") << what << ": " << s.reason();
    ASSERT_NE(s.slave_state(), "fault") << what << ": " << s.slave_reason();
    if (s.state() == "off") order("engage: true");
  }
  pb::Request text(const std::string& order) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(order, &request)) << order;
    return request;
  }

  // Each number of `request` that `field` gives, at each extreme: one alone, and all three.
  template <typename Field>
  void try_numbers(const pb::Request& request, Field field) {
    for (const double value : kExtremes) {
      for (const int which : {0, 1, 2, 3}) {
        pb::Request extreme = request;
        Numbers* numbers = field(extreme);
        if (numbers->empty()) numbers->Resize(3, 0.0);
        for (int i = 0; i < 3; ++i) {
          if (which == 3 || which == i) numbers->Set(i, value);
        }
        ASSERT_NO_FATAL_FAILURE(try_order(extreme));
      }
    }
    for (const int size : {1, 2, 4, 7000}) {
      pb::Request extreme = request;
      field(extreme)->Resize(size, 1.0);
      ASSERT_NO_FATAL_FAILURE(try_order(extreme));
    }
  }

  void end_and_expect_all_was_sent() {
    order("disengage: true");
    for (Program* program : {master.get(), slave.get()}) {
      program->send(SIGTERM);
      EXPECT_EQ(program->finish(), 0);
      EXPECT_THAT(program->after("datagrams accepted, "), HasSubstr(", 0 unsendable"));
    }
    EXPECT_GT(refused_, 0);
    EXPECT_LT(refused_, tried_) << "some must have an effect";
  }

  int tried_ = 0, refused_ = 0;
};

TEST_F(ExtremesTest, OfTools) {
  // Ends that no datagram carries.
  EXPECT_THAT(refusal("tool { kind: LINE direction: [1, 0, 0] end_mm: [10400, 0, 0] }"),
              HasSubstr("end"));
  const std::string far_end = refusal(
      "tool { kind: LINE direction: [1, 0, 0] at_mm: [-5000, 0, 0] end_mm: [5000, 100, 0] } "
      "approach: true");
  EXPECT_THAT(far_end, HasSubstr("end"));
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
  for (const char* tool : {"kind: POINT", "kind: LINE direction: [1, 0, 0]",
                           "kind: PLANE normal: [0, 0, 1] direction: [1, 0, 0]", "kind: N_ROTATION",
                           "kind: F_ROTATION axis: [0, 0, 1]"}) {
    const pb::Request request = text("tool { " + std::string(tool) + " }");
    ASSERT_NO_FATAL_FAILURE(try_order(request));
    const std::function<Numbers*(pb::Request&)> fields[] = {
        [](pb::Request& r) { return r.mutable_tool()->mutable_at_mm(); },
        [](pb::Request& r) { return r.mutable_tool()->mutable_direction(); },
        [](pb::Request& r) { return r.mutable_tool()->mutable_normal(); },
        [](pb::Request& r) { return r.mutable_tool()->mutable_axis(); },
        [](pb::Request& r) { return r.mutable_tool()->mutable_end_mm(); }};
    for (const auto& field : fields) ASSERT_NO_FATAL_FAILURE(try_numbers(request, field));
    for (const double value : kExtremes) {
      pb::Request stiff = request;
      stiff.mutable_tool()->set_stiffness_n_mm(value);
      ASSERT_NO_FATAL_FAILURE(try_order(stiff));
      pb::Request far = request;
      far.set_approach(true);
      far.mutable_tool()->mutable_at_mm()->Resize(3, value);
      ASSERT_NO_FATAL_FAILURE(try_order(far));
    }
    pb::Request one_way = request;
    one_way.mutable_tool()->set_one_way(true);
    ASSERT_NO_FATAL_FAILURE(try_order(one_way));
  }
  for (const char* other :
       {"tool {}", "tool_off {}", "tool_off { position: false orientation: false }", "tool_off {}",
        "clutch: true", "clutch: true", "tool { kind: POINT }", "clutch: false"}) {
    ASSERT_NO_FATAL_FAILURE(try_order(text(other)));
  }
  end_and_expect_all_was_sent();
}

TEST_F(ExtremesTest, OfHandsAndNames) {
  const pb::Request hand = text("hand { displacement_mm: [0, 0, 0] duration_s: 0.01 }");
  ASSERT_NO_FATAL_FAILURE(try_numbers(
      hand, [](pb::Request& r) { return r.mutable_hand()->mutable_displacement_mm(); }));
  ASSERT_NO_FATAL_FAILURE(
      try_numbers(hand, [](pb::Request& r) { return r.mutable_hand()->mutable_rotation_deg(); }));
  for (const double value : kExtremes) {
    pb::Request request = hand;
    request.mutable_hand()->set_duration_s(value);
    ASSERT_NO_FATAL_FAILURE(try_order(request));
    request.mutable_hand()->set_home(true);
    ASSERT_NO_FATAL_FAILURE(try_order(request));
  }
  const std::string names[] = {"",
                               "/",
                               "..",
                               "../../etc/passwd",
                               "a\nb",
                               "\x01",
                               "%n%s%",
                               "\xff",
                               std::string(1, '\0'),
                               std::string(kLongest, 'x'),
                               std::string(kLongest, '\n')};
  for (const std::string& name : names) {
    pb::Request stage, scene;
    stage.set_stage(name);
    ASSERT_NO_FATAL_FAILURE(try_order(stage));
    scene.set_scene_load(name);
    ASSERT_NO_FATAL_FAILURE(try_order(scene));
    for (const int act : {-1, 0, 1, 2, 3, 4}) {
      pb::Request lease;
      lease.set_as(name);
      if (act >= 0)
        lease.mutable_lease()->set_act(static_cast<pb::LeaseOrder::Act>(act));
      else
        lease.set_disengage(true);
      ASSERT_NO_FATAL_FAILURE(try_order(lease));
    }
    // Not engaged a scene is looked for.
    order("disengage: true");
    const auto reply = client.call(scene, kPatience);
    ASSERT_TRUE(reply) << reply.message();
    EXPECT_FALSE(reply->done());
    EXPECT_LT(reply->reason().size(), 1000u);
    order("engage: true");
  }
  end_and_expect_all_was_sent();
}

}  // namespace
}  // namespace handrail
