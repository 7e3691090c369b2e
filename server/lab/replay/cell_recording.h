// The recordings of both sides of a cell in virtual time, as its daemons would have written them.
#pragma once

#include <memory>
#include <ostream>
#include <string>

#include "devices/haptic_device.h"
#include "server/lab/cell/cell.h"

namespace handrail {

namespace pb {
class MasterConfig;
class RecordedScene;
class RecordedStart;
}  // namespace pb

// What a recording of a cell begins with, of either side, without times and build.
pb::RecordedStart cell_master(const pb::MasterConfig& config, const HapticCapabilities& device);
pb::RecordedStart cell_slave(Nanos period, double sensor_range);

class CellRecording {
 public:
  // From the cell's first tick on; it must outlive the cell's last. `master`, `slave`: what is
  // known of each program, without times and build. `scene`: that the cell runs, number kCellScene.
  // What is written goes to the two streams, whose errors are for who calls to see.
  CellRecording(Cell& cell, const pb::RecordedStart& master, const pb::RecordedStart& slave,
                const pb::RecordedScene& scene, std::ostream& to_master, std::ostream& to_slave);
  ~CellRecording();
  CellRecording(const CellRecording&) = delete;
  CellRecording& operator=(const CellRecording&) = delete;

  // What has come since; at least every half second of the cell's time.
  void pull();
  // On both sides, after all ticks so far.
  void mark(const std::string& text);
  // After the last pull: the files' ends.
  void finish();

 private:
  class Side;
  Cell& cell_;
  std::unique_ptr<Side> master_, slave_;
  std::unique_ptr<MasterTap> master_tap_;
  std::unique_ptr<SlaveTap> slave_tap_;
};

}  // namespace handrail
