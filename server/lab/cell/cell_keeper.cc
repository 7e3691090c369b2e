#include "server/lab/cell/cell_keeper.h"

#include <utility>

namespace handrail {

void CellKeeper::before_tick(Nanos now, const HapticRun& run) noexcept {
  if (master_ == nullptr) return;
  ++tick_.number;
  if (master_begins_ == 0 && !master_->image_due(now)) return;
  MasterTap::Image& image = master_->image();
  image.number = tick_.number;
  image.scene = kCellScene;
  image.begins = std::exchange(master_begins_, 0);
  image.size = run.save(image.bytes);
  master_->keep_image(now);
}

void CellKeeper::after_tick(Nanos now, const HapticTick& given, const KeptTiming& timing,
                            const HapticRun& run) noexcept {
  if (master_ == nullptr) return;
  tick_.at = now;
  tick_.scene = kCellScene;
  tick_.given = given;
  tick_.timing = timing;
  tick_.came = run.result();
  master_->keep(tick_);
}

void CellKeeper::before_cycle(Nanos now, const FollowState& state,
                              const FollowOutput& out) noexcept {
  if (slave_ == nullptr) return;
  ++cycle_.number;
  if (slave_begins_ == 0 && !slave_->image_due(now)) return;
  SlaveTap::Image& image = slave_->image();
  image.number = cycle_.number;
  image.scene = kCellScene;
  image.begins = std::exchange(slave_begins_, 0);
  image.size = save_follow(state, out, image.bytes);
  slave_->keep_image(now);
}

void CellKeeper::after_cycle(Nanos now, const JointVector* placed, const FollowInput& given,
                             const KeptTiming& timing, const FollowOutput& out) noexcept {
  if (slave_ == nullptr) return;
  cycle_.at = now;
  cycle_.scene = kCellScene;
  cycle_.placed = placed != nullptr;
  cycle_.place = placed != nullptr ? *placed : JointVector::Zero().eval();
  cycle_.given = given;
  cycle_.timing = timing;
  cycle_.came = out;
  slave_->keep(cycle_);
}

}  // namespace handrail
