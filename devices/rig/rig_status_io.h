// The words of the rig's status socket (proto/rig.proto), from and to bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/rig/rig_feed.h"
#include "server/base/status.h"

namespace handrail {

// Moments told in one answer: 25 KiB of them. Who asks every 100 ms misses none.
inline constexpr std::size_t kMostMoments = 128;
// Kept for who asks late: 2 s.
inline constexpr std::size_t kKeptMoments = 2048;

// What is known at the socket. For one thread.
class RigBoard {
 public:
  // `piece` of the scene called `name`, or the error; may read a disk.
  using FindWorkpiece = std::function<Result<Workpiece>(const std::string& name)>;
  // Puts it in its place.
  using Play = std::function<Result<std::optional<TipInside>>(const Workpiece&)>;

  // `scene`: whose workpiece the rig starts with; empty: none.
  RigBoard(std::string scene, FindWorkpiece find, Play play)
      : scene_(std::move(scene)), find_(std::move(find)), play_(std::move(play)) {}

  void hear(const RigMoment& moment);
  // The answer to an order's bytes. What is wrong with one is said in it.
  std::string answer(std::string_view order);

 private:
  Status play(const std::string& scene, bool anew);
  std::string look(std::optional<std::uint64_t> since) const;

  std::string scene_;
  FindWorkpiece find_;
  Play play_;
  std::deque<RigMoment> moments_;
};

// An answer that says no.
std::string rig_refusal(const std::string& reason);

// As RigBoard wants them: in these folders first, then the scenes shipped.
RigBoard::FindWorkpiece workpiece_finder(std::vector<std::string> folders);

}  // namespace handrail
