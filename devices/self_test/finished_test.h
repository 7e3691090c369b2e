// What was found out at once, as a test that has ended.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "devices/driver.h"

namespace handrail {

class FinishedTest final : public SelfTest {
 public:
  FinishedTest(std::vector<TestItem> items, std::string block)
      : items_(std::move(items)), block_(std::move(block)) {}

  bool turn(Nanos) override { return false; }
  std::string asks() const override { return {}; }
  std::vector<TestItem> items() const override { return items_; }
  std::string block() const override { return block_; }

 private:
  std::vector<TestItem> items_;
  std::string block_;
};

}  // namespace handrail
