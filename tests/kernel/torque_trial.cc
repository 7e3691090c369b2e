#include <array>
#include <cmath>
#include <string>

#include "devices/comedi/ft_scale.h"
#include "devices/comedi/joystick_card.h"
#include "server/base/plain_text.h"
#include "tests/kernel/trial.h"

namespace handrail::kernel {
namespace {

constexpr ComediChannel kBack[] = {{0, 0, 0, 0}, {0, 1, 0, 0}};  // inputs 0 and 1

// At the inputs that the driver connects with outputs 0 and 1 [V].
std::array<double, 2> read_back(ComediCard& card) {
  std::array<unsigned int, 2> raw{};
  if (card.read(kBack, raw) != 0) return {99.0, 99.0};
  return {comedi_value(raw[0], {-10.0, 10.0, 0}, 65535),
          comedi_value(raw[1], {-10.0, 10.0, 0}, 65535)};
}

bool near(double a, double b) { return std::abs(a - b) <= 20.0 / 65535.0; }

}  // namespace

bool try_torques() {
  const auto api = load_comedi(kComediLibrary);
  if (!api) return said(false, api.message());
  const ComediJoystickOptions options;
  bool good = true;
  {
    auto card = ComediCard::open(*api, options.place);
    if (!card) return said(false, card.message());
    auto torques = JoystickTorques::find(*card, options);
    if (!torques) return said(false, torques.message());
    const Status held = torques->hold(*card);
    good &= said(held.is_ok(), "two torques at " + card->board() + " " + held.message());
    int off = 0, tried = 0;
    // 10 V are 3.8 N m, at 15 cm 25.3 N.
    for (double x = -25.0; x <= 25.0; x += 0.25) {
      const double y = 0.5 * x - 3.0;
      const int error = torques->push(*card, {x, y});
      const auto back = read_back(*card);
      ++tried;
      const bool same = error == 0 && near(back[0], x * 0.15 * 10.0 / 3.8) &&
                        near(back[1], y * 0.15 * 10.0 / 3.8);
      off += same ? 0 : 1;
    }
    good &= said(off == 0, std::to_string(off) + " of " + std::to_string(tried) +
                               " pairs of torques came back otherwise");
    auto other = ComediCard::open(*api, options.place);
    const Status refused = other ? torques->hold(*other) : other.status();
    good &= said(!refused.is_ok(), "a second program: " + refused.message());
    (void)torques->push(*card, {10.0, -10.0});
  }
  // As after a program that was killed: the kernel leaves the voltages, and who opens it next takes
  // them away.
  auto next = ComediCard::open(*api, options.place);
  if (!next) return said(false, next.message());
  const auto left = read_back(*next);
  good &= said(near(left[0], 10.0 * 0.15 * 10.0 / 3.8),
               "left by a program that is gone: " + number_text(left[0]) + " V");
  auto torques = JoystickTorques::find(*next, options);
  const Status held = torques ? torques->hold(*next) : torques.status();
  const auto now = read_back(*next);
  good &= said(held.is_ok() && near(now[0], 0.0) && near(now[1], 0.0), "taken away by the next");
  return good;
}

}  // namespace handrail::kernel
