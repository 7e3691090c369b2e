// The lab's check of the prices that `scene explain` lists.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace handrail {

struct PriceCommand {
  std::string scene;
};

struct CheckedPrice {
  std::string name;
  double listed = 0.0;  // by `scene explain` [ns a tick]
  double saved = 0.0;   // by a scene without it, see effect_price.h [ns a tick]

  // What `saved` may differ by: the larger of 15 % of the price and 5 ns.
  double tolerance() const noexcept;
  bool agrees() const noexcept;
};

// Prices, side by side, and the verdict.
std::string price_table(const std::vector<CheckedPrice>& prices);

// Exit codes: 0 all agree, 1 some do not, 2 bad scene or one without walls, 130 cancelled. Takes
// some seconds.
int run_price_command(const PriceCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
