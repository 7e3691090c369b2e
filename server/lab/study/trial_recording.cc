#include "server/lab/study/trial_recording.h"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "devices/omni/omni_data.h"
#include "proto/config.pb.h"
#include "proto/record.pb.h"
#include "proto/scene.pb.h"
#include "server/lab/study/study_bench.h"

namespace handrail {
namespace {

pb::MasterConfig config_of_studies() {
  pb::MasterConfig out;
  // As haptic_settings() leaves it without a configuration.
  out.set_presence(pb::MasterConfig::NONE);
  out.set_governor(false);
  out.set_good_link_ms(0);
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

Status TrialRecording::is_new(const std::string& folder, const std::string& trial) {
  const std::string file = file_name(folder, trial) + ".master.mcap";
  if (!std::filesystem::exists(file)) return Status::ok();
  return Status::error(file + ": is there already; --record with another folder");
}

TrialRecording::TrialRecording(Cell& cell, const StudyMachine& machine, const std::string& trial)
    : trial_(trial),
      name_(file_name(machine.recording.folder, trial)),
      master_(name_ + ".master.mcap", std::ios::binary),
      slave_(name_ + ".slave.mcap", std::ios::binary),
      recording_(std::make_unique<CellRecording>(
          cell, cell_master(config_of_studies(), omni_capabilities(machine.torque)),
          cell_slave(machine.rig.controller.period, kStudySensorRange),
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

std::string scene_file_text(const pb::Scene& scene) {
  std::string out;
  // A message of ours always has a text.
  (void)google::protobuf::TextFormat::PrintToString(scene, &out);
  return out;
}

std::string text_without_protection(const std::string& text) {
  pb::Scene raw;
  // It is one that scene_file_text() has made.
  (void)google::protobuf::TextFormat::ParseFromString(text, &raw);
  raw.mutable_bumper()->set_enabled(false);
  raw.mutable_guidance()->set_spring_n_mm(0.0);
  return scene_file_text(raw);
}

}  // namespace handrail
