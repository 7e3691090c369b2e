#include "server/scene/simulate_io.h"

#include <gtest/gtest.h>

#include <set>

#include "server/scene/scene_io.h"

namespace handrail {
namespace {

// Reads "simulate { ... }" from line 2 on.
Result<Scene> read(const std::string& effects) {
  return parse_scene("/x/a.scene", "name: 'a'\nsimulate { " + effects + " }");
}
Simulate simulate_of(const std::string& effects) {
  const Result<Scene> scene = read(effects);
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_TRUE(scene && scene->simulate);
  return scene && scene->simulate ? *scene->simulate : Simulate();
}
std::string simulate_error_of(const std::string& effects) { return read(effects).message(); }

constexpr char kPlane[] = "effect { plane { at_mm: [0, 0, 0] normal: [0, 0, 1] } }\n";
constexpr char kSocket[] = "effect { hex_socket { at_mm: [350, 0, 100] axis: [0, 0, 1] } }\n";

TEST(SimulateIo, ASceneWithoutTheBlockLeavesTheRigAsItIsConfigured) {
  EXPECT_FALSE(parse_scene("/x/a.scene", "name: 'a'")->simulate);
  EXPECT_TRUE(simulate_of("").effects.empty()) << "an empty block runs nothing";
}

TEST(SimulateIo, DefaultsOfTheFileAndOfTheStructsAgree) {
  const Simulate s = simulate_of(
      "effect { servo_lag {} } effect { encoder_offsets {} } effect { arm_compliance {} }"
      "effect { tool_compliance {} } effect { screw_thread {} } effect { sensor_noise {} }"
      "effect { sensor_drift {} } effect { sensor_quantisation {} }"
      "effect { sensor_saturation {} } effect { gravity_sag { payload_kg: 1 } }" +
      std::string(kSocket));
  EXPECT_EQ(s.find<ServoLagSpec>()->lag, ServoLagSpec().lag);
  EXPECT_EQ(s.find<ServoLagSpec>()->spread, ServoLagSpec().spread);
  EXPECT_DOUBLE_EQ(s.find<EncoderOffsetsSpec>()->repeatability, EncoderOffsetsSpec().repeatability);
  EXPECT_EQ(s.find<ArmComplianceSpec>()->stiffness, ArmComplianceSpec().stiffness);
  EXPECT_EQ(s.find<ToolComplianceSpec>()->axial, ToolComplianceSpec().axial);
  EXPECT_EQ(s.find<ToolComplianceSpec>()->lateral, ToolComplianceSpec().lateral);
  EXPECT_EQ(s.find<ToolComplianceSpec>()->twist, ToolComplianceSpec().twist);
  EXPECT_EQ(s.find<ScrewThreadSpec>()->start, ScrewThreadSpec().start);
  EXPECT_DOUBLE_EQ(s.find<ScrewThreadSpec>()->seat, ScrewThreadSpec().seat);
  EXPECT_EQ(s.find<ScrewThreadSpec>()->growth, ScrewThreadSpec().growth);
  EXPECT_EQ(s.find<ScrewThreadSpec>()->back_share, ScrewThreadSpec().back_share);
  EXPECT_EQ(s.find<SensorNoiseSpec>()->force, SensorNoiseSpec().force);
  EXPECT_EQ(s.find<SensorNoiseSpec>()->torque, SensorNoiseSpec().torque);
  EXPECT_EQ(s.find<SensorDriftSpec>()->rate, SensorDriftSpec().rate);
  EXPECT_EQ(s.find<SensorDriftSpec>()->range, SensorDriftSpec().range);
  EXPECT_TRUE(s.find<SensorDriftSpec>()->start.force.isZero(0.0));
  EXPECT_TRUE(s.find<SensorDriftSpec>()->start.torque.isZero(0.0));
  EXPECT_EQ(s.find<SensorQuantisationSpec>()->force, SensorQuantisationSpec().force);
  EXPECT_EQ(s.find<SensorQuantisationSpec>()->torque, SensorQuantisationSpec().torque);
  EXPECT_EQ(s.find<SensorSaturationSpec>()->force, SensorSaturationSpec().force);
  EXPECT_EQ(s.find<SensorSaturationSpec>()->torque, SensorSaturationSpec().torque);
  EXPECT_EQ(s.find<GravitySpec>()->stiffness, GravitySpec().stiffness);
  const HexSocketSpec& socket = *s.find<HexSocketSpec>();
  const HexSocketSpec made;
  EXPECT_DOUBLE_EQ(socket.across_flats, made.across_flats);
  EXPECT_DOUBLE_EQ(socket.key, made.key);
  EXPECT_DOUBLE_EQ(socket.depth, made.depth);
  EXPECT_DOUBLE_EQ(socket.chamfer, made.chamfer);
  EXPECT_DOUBLE_EQ(socket.guide, made.guide);
  EXPECT_DOUBLE_EQ(socket.backlash, made.backlash);
  EXPECT_DOUBLE_EQ(socket.jam, made.jam);
  EXPECT_EQ(socket.surface.stiffness, made.surface.stiffness);
  EXPECT_EQ(socket.surface.damping, made.surface.damping);
  EXPECT_EQ(socket.surface.friction, made.surface.friction);
}

TEST(SimulateIo, ConvertsToSi) {
  const Simulate s = simulate_of(
      "effect { plane { at_mm: [1, 2, 3] normal: [0, 0, 5] "
      "  surface { n_mm: 20 n_s_mm: 0.1 friction: 0 } } }"
      "effect { box { at_mm: [4, 5, 6] size_mm: [10, 20, 30] turn_deg: [0, 0, 90] } }"
      "effect { cylinder { at_mm: [7, 8, 9] axis: [2, 0, 0] radius_mm: 3 length_mm: 40"
      "  hole: true } }"
      "effect { joint_backlash { joint_deg: [0, 0, 0, 0, 0, 0.1] } }"
      "effect { gravity_sag { payload_kg: 2 centre_mm: [0, 0, -50] } }"
      "effect { servo_lag { lag_ms: 0 } } effect { arm_compliance { n_mm: 30 } }"
      "effect { sensor_drift { start_n: [1, -2, 3] start_n_m: [0.4, 0.5, -0.6] } }");
  ASSERT_EQ(s.effects.size(), 8u);
  EXPECT_EQ(s.find<SensorDriftSpec>()->start.force, Vec3(1, -2, 3));
  EXPECT_EQ(s.find<SensorDriftSpec>()->start.torque, Vec3(0.4, 0.5, -0.6));
  const PlaneSpec& plane = *s.find<PlaneSpec>();
  EXPECT_TRUE(plane.at.isApprox(Vec3(0.001, 0.002, 0.003)));
  EXPECT_EQ(plane.normal, Vec3::UnitZ());
  EXPECT_DOUBLE_EQ(plane.surface.stiffness, 20e3);
  EXPECT_DOUBLE_EQ(plane.surface.damping, 100.0);
  EXPECT_EQ(plane.surface.friction, 0.0);
  const BoxSpec& box = *s.find<BoxSpec>();
  EXPECT_TRUE(box.half.isApprox(Vec3(0.005, 0.010, 0.015)));
  EXPECT_TRUE((box.X_SB.q * Vec3::UnitX()).isApprox(Vec3::UnitY()));
  const CylinderSpec& cylinder = *s.find<CylinderSpec>();
  EXPECT_EQ(cylinder.axis, Vec3::UnitX());
  EXPECT_DOUBLE_EQ(cylinder.radius, 0.003);
  EXPECT_DOUBLE_EQ(cylinder.half_length, 0.020);
  EXPECT_TRUE(cylinder.hole);
  EXPECT_DOUBLE_EQ(s.find<BacklashSpec>()->play[5], 0.1 * kDeg);
  EXPECT_TRUE(s.find<GravitySpec>()->p_TC.isApprox(Vec3(0, 0, -0.05)));
  EXPECT_EQ(s.find<ServoLagSpec>()->lag, 0.0);
  EXPECT_DOUBLE_EQ(s.find<ArmComplianceSpec>()->stiffness, 30e3);
}

TEST(SimulateIo, ASocketOpensAlongItsAxis) {
  const Simulate s = simulate_of("effect { hex_socket { at_mm: [350, 0, 250] axis: [0, 3, 4] } }");
  const Pose& X_SK = s.find<HexSocketSpec>()->X_SK;
  EXPECT_TRUE((X_SK.q * Vec3::UnitZ()).isApprox(Vec3(0, 0.6, 0.8)));
  EXPECT_TRUE(X_SK.p.isApprox(Vec3(0.35, 0, 0.25)));
  const Simulate down =
      simulate_of("effect { hex_socket { at_mm: [350, 0, 950] axis: [0, 0, -1] } }");
  EXPECT_TRUE((down.find<HexSocketSpec>()->X_SK.q * Vec3::UnitZ()).isApprox(-Vec3::UnitZ()));
}

TEST(SimulateIo, RefusesAKeyThatDoesNotFit) {
  EXPECT_EQ(
      simulate_error_of("effect { hex_socket { at_mm: [0, 0, 0] axis: [0, 0, 1]\nkey_mm: 6.1 } }"),
      "/x/a.scene:3:1: field 'simulate.effect[0].hex_socket.key_mm': key_mm 6.1 does not fit "
      "across_flats_mm 6.05");
  EXPECT_EQ(
      simulate_error_of(
          "effect { hex_socket { at_mm: [0, 0, 0] axis: [0, 0, 1]\nacross_flats_mm: 6 } }"),
      "/x/a.scene:3:1: field 'simulate.effect[0].hex_socket.across_flats_mm': key_mm 6 does not "
      "fit across_flats_mm 6");
  EXPECT_EQ(simulate_error_of(
                "effect { hex_socket { at_mm: [0, 0, 0] axis: [0, 0, 1]\ndepth_mm: 1.3 } }"),
            "/x/a.scene:3:1: field 'simulate.effect[0].hex_socket.depth_mm': 1.3 is not below "
            "chamfer_mm and guide_mm, which end at 1.3 mm");
}

TEST(SimulateIo, RefusesASocketOfRubber) {
  EXPECT_EQ(simulate_error_of(
                "effect { hex_socket { at_mm: [0, 0, 0] axis: [0, 0, 1]\nsurface {\nn_mm: 99 "
                "} } }"),
            "/x/a.scene:4:1: field 'simulate.effect[0].hex_socket.surface.n_mm': 99 is too soft "
            "for a socket, expected at least 100 N/mm");
}

TEST(SimulateIo, RefusesAThreadWithoutASocket) {
  EXPECT_EQ(simulate_error_of("effect { servo_lag {} }\neffect { screw_thread {} }"),
            "/x/a.scene:3:10: field 'simulate.effect[1].screw_thread': has no hex_socket, by which "
            "the screw is turned");
  EXPECT_EQ(simulate_of("effect { screw_thread {} } " + std::string(kSocket)).effects.size(), 2u)
      << "in any order";
}

TEST(SimulateIo, RefusesADirectionOfNoLength) {
  EXPECT_EQ(simulate_error_of("effect { plane { at_mm: [0, 0, 0]\nnormal: [0, 0, 0] } }"),
            "/x/a.scene:3:1: field 'simulate.effect[0].plane.normal': has no direction");
  EXPECT_EQ(simulate_error_of("effect { cylinder { at_mm: [0, 0, 0]\naxis: [0, 0, 0] radius_mm: 1 "
                              "length_mm: 1 } }"),
            "/x/a.scene:3:1: field 'simulate.effect[0].cylinder.axis': has no direction");
  EXPECT_EQ(simulate_error_of("effect { hex_socket { at_mm: [0, 0, 0]\naxis: [0, 0, 0] } }"),
            "/x/a.scene:3:1: field 'simulate.effect[0].hex_socket.axis': has no direction");
}

TEST(SimulateIo, RefusesWhatIsMissingOrOutOfRange) {
  EXPECT_EQ(simulate_error_of("effect { plane { at_mm: [0, 0, 0] } }"),
            "/x/a.scene:2:21: field 'simulate.effect[0].plane.normal': missing, but required");
  EXPECT_EQ(simulate_error_of("effect { joint_backlash { joint_deg: [1, 2] } }"),
            "/x/a.scene:2:38: field 'simulate.effect[0].joint_backlash.joint_deg': 2 values, "
            "expected 6");
  EXPECT_EQ(simulate_error_of("effect { gravity_sag { payload_kg: -1 } }"),
            "/x/a.scene:2:35: field 'simulate.effect[0].gravity_sag.payload_kg': -1 is outside 0 "
            "to 20 kg");
  EXPECT_EQ(simulate_error_of("effect { arm_compliance { n_mm: 0 } }"),
            "/x/a.scene:2:38: field 'simulate.effect[0].arm_compliance.n_mm': 0 is outside 1 to "
            "100000 N/mm");
}

TEST(SimulateIo, RefusesWhatIsListedTwiceOrTooOften) {
  EXPECT_EQ(simulate_error_of("effect { servo_lag {} }\neffect { servo_lag { lag_ms: 30 } }"),
            "/x/a.scene:3:1: field 'simulate.effect[1]': servo_lag is listed twice");
  EXPECT_EQ(simulate_error_of(kSocket + std::string(kSocket)),
            "/x/a.scene:3:1: field 'simulate.effect[1]': hex_socket is listed twice");
  std::string eight = kSocket;
  for (int i = 0; i < 7; ++i) eight += kPlane;
  EXPECT_EQ(simulate_of(eight).effects.size(), 8u);
  EXPECT_EQ(simulate_error_of(eight + kPlane),
            "/x/a.scene:10:1: field 'simulate.effect[8]': more things to touch than 8");
}

TEST(SimulateIo, EachEntryHoldsOneEffectAndAnArmTakesPart) {
  EXPECT_EQ(simulate_error_of("\neffect {}"),
            "/x/a.scene:3:1: field 'simulate.effect[0]': 0 effects in one entry, expected exactly "
            "1");
  EXPECT_EQ(simulate_error_of("\neffect { servo_lag {} arm_compliance {} }"),
            "/x/a.scene:3:1: field 'simulate.effect[0]': 2 effects in one entry, expected exactly "
            "1");
  EXPECT_EQ(parse_scene("/x/a.scene",
                        "name: 'a'\nsimulate {}\nwalls { region { name: 'w' kind: WALL } region { "
                        "name: 'f' kind: FREE } shape { disc { centre_mm: [0, 0] radius_mm: 9 "
                        "region: 'f' } } }")
                .message(),
            "/x/a.scene:2:1: field 'simulate': no arm takes part in a scene of walls");
}

TEST(SimulateIo, IsNoneOfTheOtherSidesBusiness) {
  const Result<Scene> with = read(kPlane);
  const Result<Scene> without = parse_scene("/x/a.scene", "name: 'a'");
  const SectionHashes a = section_hashes(*with), b = section_hashes(*without);
  EXPECT_EQ(a.mapping, b.mapping);
  EXPECT_EQ(a.limits, b.limits);
  EXPECT_EQ(a.robot, b.robot);
}

TEST(Simulate, EveryKindHasANameOfItsOwn) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(RigEffectKind::kCount); ++i) {
    names.insert(name_of(static_cast<RigEffectKind>(i)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(RigEffectKind::kCount) + 1);
  EXPECT_EQ(name_of(kind_of(RigEffectSpec(HexSocketSpec()))), std::string("hex_socket"));
  EXPECT_EQ(name_of(kind_of(RigEffectSpec(SensorSaturationSpec()))),
            std::string("sensor_saturation"));
  EXPECT_TRUE(is_touched(RigEffectKind::kBox));
  EXPECT_FALSE(is_touched(RigEffectKind::kScrewThread));
}

}  // namespace
}  // namespace handrail
