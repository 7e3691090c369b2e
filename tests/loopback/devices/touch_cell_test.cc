// A whole cell whose hand is a Touch, over the stand-in for the vendor's library.
#include <gmock/gmock.h>
#include <signal.h>

#include "server/base/pacer.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

class TouchOfACell : public WholeCell {
 protected:
  TouchOfACell() {
    device_kind = "kind: TOUCH touch { library: '" HANDRAIL_HD_STAND_IN "' }";
    master_extra = "presence: NONE";
  }
  bool engages() {
    return within(kPatience, [&] {
      (void)ask("reset: true");
      return ask("engage: true").done() && reaches("engaged");
    });
  }
};

TEST_F(TouchOfACell, ItEngagesAndAfterTheMasterStoodStillItDoesAgain) {
  ASSERT_TRUE(engages());
  EXPECT_EQ(status().device(), "Touch");
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t before = status().ticks();
    master->send(SIGSTOP);
    sleep_until(monotonic_now() + 300 * kMillisecond);
    master->send(SIGCONT);
    // Its turns go on, by the device's clock as before, and what was missed is not caught up with.
    ASSERT_TRUE(eventually([&](const pb::Status& s) { return s.ticks() > before + 500; }));
    ASSERT_TRUE(engages()) << i;
  }
  EXPECT_GE(status().overruns(), 3u);
}

}  // namespace
}  // namespace handrail
