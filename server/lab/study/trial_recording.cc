#include "server/lab/study/trial_recording.h"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "devices/omni/omni_data.h"
#include "proto/config.pb.h"
#include "server/lab/study/study_bench.h"
#include "server/record/device_io.h"
#include "server/record/record_setup.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

pb::RecordedStart master_start(const StudyMachine& machine) {
  pb::MasterConfig config;
  // As haptic_settings() leaves them without a configuration.
  config.set_presence(pb::MasterConfig::NONE);
  config.set_governor(false);
  config.set_good_link_ms(0);
  pb::RecordedStart out = recorded_start("handrail-master", 1, config);
  put(omni_capabilities(machine.torque), *out.mutable_device());
  return out;
}

pb::RecordedStart slave_start(const StudyMachine& machine) {
  pb::RecordedStart out = recorded_start("handrail-slave", 1, pb::SlaveConfig());
  *out.mutable_arm() = recorded_arm(machine.rig.controller.period, true, kStudySensorRange);
  return out;
}

pb::RecordedScene recorded_study_scene(const StudyMachine& machine) {
  pb::RecordedScene out;
  out.set_number(kCellScene);
  out.set_name(machine.scene.name);
  out.set_text(machine.recording.scene_text);
  return out;
}

std::string file_name(const std::string& folder, std::string trial) {
  std::replace(trial.begin(), trial.end(), ' ', '-');
  return folder + "/" + trial;
}

}  // namespace

TrialRecording::TrialRecording(Cell& cell, const StudyMachine& machine, const std::string& trial)
    : trial_(trial),
      name_(file_name(machine.recording.folder, trial)),
      master_(name_ + ".master.mcap", std::ios::binary),
      slave_(name_ + ".slave.mcap", std::ios::binary),
      recording_(std::make_unique<CellRecording>(cell, master_start(machine), slave_start(machine),
                                                 recorded_study_scene(machine), master_, slave_)) {
  recording_->mark("trial begins: " + trial_ + " simulated");
}

Status TrialRecording::finish(const std::string& end) {
  recording_->mark("trial ends: " + trial_ + " simulated " + end);
  recording_->finish();
  for (auto& [file, side] : {std::pair<std::ofstream&, const char*>{master_, ".master.mcap"},
                             std::pair<std::ofstream&, const char*>{slave_, ".slave.mcap"}}) {
    file.close();
    if (!file) {
      return Status::error(name_ + side + ": cannot be written: " + std::strerror(errno));
    }
  }
  return Status::ok();
}

Result<std::string> scene_text(const Scene& scene, const std::vector<Override>& overrides) {
  pb::Scene raw;
  const auto loaded = load_scene_file(scene.file, &raw, overrides);
  if (!loaded) return loaded.status();
  std::string out;
  google::protobuf::TextFormat::PrintToString(raw, &out);
  return out;
}

std::string text_without_protection(const std::string& text) {
  pb::Scene raw;
  std::string out;
  if (!google::protobuf::TextFormat::ParseFromString(text, &raw)) return text;
  raw.mutable_bumper()->set_enabled(false);
  raw.mutable_guidance()->set_spring_n_mm(0.0);
  google::protobuf::TextFormat::PrintToString(raw, &out);
  return out;
}

}  // namespace handrail
