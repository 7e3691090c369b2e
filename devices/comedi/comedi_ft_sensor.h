// A force/torque sensor at a card that comedi drives.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "devices/comedi/ft_source.h"
#include "devices/ft_sensor.h"
#include "server/base/mailbox.h"

namespace handrail {

// Read by a thread of its own, so that who polls never waits for a card. Unplugged or silent, it
// gives a record a hundredth of a second apart whose status says so, and goes on by itself when
// card and sensor are back. After it was not there, readings count only when the sensor's low pass
// has settled.
//
// FtSample::sequence counts periods of the configured rate that have gone, so that what was missed
// shows; FtSample::status is in ft_scale.h.
class ComediFtSensor final : public FtSensor {
 public:
  // Told, from the thread, what became of the card: one line each time that it changes.
  using Say = std::function<void(bool bad, const std::string& line)>;

  explicit ComediFtSensor(const ComediFtOptions& options, Say say = {});
  ~ComediFtSensor() override { stop(); }

  const FtCapabilities& capabilities() const override { return capabilities_; }
  // The error tells why there will be none: no library, no card, no permission, another board. What
  // only takes time, a sensor that settles, is no error.
  Status start() override;
  bool poll(Nanos now, FtSample& sample) noexcept override;
  void bias() noexcept override;
  void stop() noexcept override;

  // What is known of the card, in words. May block and allocate.
  std::string text() const;
  // Least full scales, once they are known; else 0 [N], [N m].
  std::pair<double, double> full_scale() const noexcept {
    return {full_force_.load(std::memory_order_relaxed),
            full_torque_.load(std::memory_order_relaxed)};
  }

 private:
  void run();
  Status open_source();
  void open_again(bool already);
  void note(FtTaken taken, const FtReading& reading) noexcept;
  void publish(const FtReading& reading, std::uint32_t status) noexcept;
  void say(bool bad, const std::string& line);
  bool waits_until(Nanos time) noexcept;

  ComediFtOptions options_;
  Say say_;
  FtCapabilities capabilities_;
  ComediApi api_;
  std::unique_ptr<ComediFtSource> source_;
  bool loaded_ = false;  // of who starts it, and of the thread while there is one
  std::thread thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<double> full_force_{0.0}, full_torque_{0.0};
  Mailbox<FtSample> samples_;
  mutable std::mutex mutex_;
  std::string text_;  // under the mutex

  // Of the thread.
  std::uint32_t sequence_ = 0;
  Nanos counts_from_ = -kForever;  // when readings count
  Nanos said_at_ = -kForever;      // that there is none
  Nanos waiting_since_ = -kForever;
  bool waiting_ = true;
  bool named_ = false;  // that it waits too long

  // Of who polls.
  Wrench zero_;
  Wrench newest_;  // as read
};

}  // namespace handrail
