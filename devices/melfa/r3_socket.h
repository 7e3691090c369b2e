// The way to a controller's own switches over TCP.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "devices/melfa/r3_switches.h"

namespace handrail {

// One connection. Every wait is bounded: a second to connect, a second for an answer and
// kMostR3Answer bytes. As nothing ends an answer but silence, one of 30 ms does.
class R3Socket final : public R3Line {
 public:
  using Interrupted = std::function<bool()>;

  // `address`: IPv4. The error is "PLACE: cause; what to do".
  static Result<std::unique_ptr<R3Socket>> connect(const std::string& address, std::uint16_t port,
                                                   Interrupted interrupted = {});
  ~R3Socket() override;
  R3Socket(const R3Socket&) = delete;
  R3Socket& operator=(const R3Socket&) = delete;

  Result<R3Answer> ask(const std::string& order) override;
  void pause(Nanos time) override;
  bool interrupted() const override;
  void finish() override { finishing_ = true; }

 private:
  R3Socket(int fd, std::string place, Interrupted interrupted)
      : fd_(fd), place_(std::move(place)), interrupted_(std::move(interrupted)) {}
  bool wait(short events, Nanos until) const;
  void drop_waiting() const;
  Status cannot(const std::string& cause, const std::string& next) const;

  int fd_;
  std::string place_;
  Interrupted interrupted_;
  bool finishing_ = false;
};

}  // namespace handrail
