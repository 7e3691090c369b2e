// What a force sensor at a card reads, one reading after the other.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "devices/comedi/comedi_card.h"
#include "devices/comedi/ft_scale.h"
#include "devices/ft_mount.h"
#include "devices/input/reopen_pause.h"

namespace handrail {

enum class ComediFtKind : std::uint8_t {
  kJr3,     // JR3's own card
  kAnalog,  // six voltages
};

struct ComediFtOptions {
  ComediFtKind kind = ComediFtKind::kJr3;
  ComediPlace place;
  std::optional<unsigned int> subdevice;                      // none: the first with analog inputs
  double rate = 1000.0;                                       // readings [Hz]
  unsigned int filter = 1;                                    // JR3, 0 to 6
  std::array<unsigned int, 6> channels = {0, 1, 2, 3, 4, 5};  // the rest: analog
  unsigned int range = 0, reference = 2;
  FtMatrix matrix = FtMatrix::Zero();
  FtSix bias = FtSix::Zero();  // [V]
  double range_n = 1000.0;     // |force| per axis the sensor can measure [N]
  double range_n_m = 100.0;    // |torque| per axis [N m]
  FtMount mount;
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
  // A card or a library that is not there as it is started is no error: it is looked for, as one
  // that was lost.
  // Starting opens nothing by itself then, and so does not block.
  bool waits = false;
};

enum class FtTaken : std::uint8_t {
  kReading,
  kNothing,  // none came in a tenth of a second, or the thread is to end
  kNotYet,   // the card does not give any yet: it begins, or its sensor was changed
  kLost,     // card or sensor is gone: open it anew
};

// Used by one thread.
class ComediFtSource {
 public:
  virtual ~ComediFtSource() = default;
  // Opens the card, and looks whether it is what is configured. Blocks.
  virtual Status open(const ComediApi& api) = 0;
  virtual void close() noexcept = 0;
  // Waits for the next reading. `periods`: how many of the configured rate have gone since the
  // last, at least 1.
  virtual FtTaken take(FtReading& out, std::uint32_t& periods) noexcept = 0;
  // After kNotYet became kReading: how long the readings do not count yet.
  virtual Nanos settling() const noexcept = 0;
  // For people, of what is open: "jr3_pci_1, full scale 200 N ...".
  virtual std::string text() const = 0;
  // Least full scale of a force and of a torque; 0: not known [N], [N m].
  virtual std::pair<double, double> full_scale() const noexcept { return {0.0, 0.0}; }
};

// Asks for six numbers each period: a JR3, whose driver has no other way, or a card that does not
// stream. Or a stream of voltages by the card's own clock.
std::unique_ptr<ComediFtSource> make_ft_source(const ComediFtOptions& options);

}  // namespace handrail
