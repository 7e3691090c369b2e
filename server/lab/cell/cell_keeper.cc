#include "server/lab/cell/cell_keeper.h"

namespace handrail {

void CellKeeper::before_tick(Nanos now, const HapticRun& run) noexcept {
  if (master_ == nullptr) return;
  master_->image_before(++tick_.number, now, kCellScene, master_begins_,
                        [&](auto& bytes) { return run.save(bytes); });
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
  slave_->image_before(++cycle_.number, now, kCellScene, slave_begins_,
                       [&](auto& bytes) { return save_follow(state, out, bytes); });
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
