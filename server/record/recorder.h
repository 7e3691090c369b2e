// Writes down what a daemon's real-time thread does, in a thread that nobody waits for.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "proto/record.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/record/record_feed.h"

namespace handrail {

struct RecorderOptions {
  std::string folder;                         // made when it is missing
  std::uint64_t keep_bytes = 2'000'000'000;   // of all recordings there; the oldest go first
  Nanos keep_for = 30 * 24 * 3600 * kSecond;  // older ones go
  Nanos before = 30 * kSecond;                // that is kept of what came before a stop or fault
  Nanos after = 2 * kSecond;                  // ... and after it
  std::function<void(bool bad, const std::string& line)> say;  // for the log; from its own thread
};

// What is known of the recorder at a moment.
struct RecorderState {
  std::string file;         // being written; empty: none
  std::uint64_t bytes = 0;  // of it, so far
  std::string problem;      // with the disk, which may also be slow; empty: none
  std::uint64_t lost = 0;   // ticks or cycles that could not be kept, so far
};

// Keeps the last half minute, and writes a file when somebody asks or something happens: a stop or
// a fault. A file stands on the disk chunk by chunk, 0.1 s each. All methods from any thread, which
// is not kept waiting: they leave word and return.
class Recorder {
 public:
  // Throws std::system_error where no thread can be had. `start`: what every file begins with,
  // without times and reasons.
  Recorder(RecorderOptions options, std::unique_ptr<RecordFeed> feed, pb::RecordedStart start);
  // Writes out what came until now, and waits for the disk; see end().
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // A scene that ticks from now on may name. Before the first that does.
  void scene(pb::RecordedScene scene);
  // `label`: part of the file's name, empty or as is_record_label() has it. From now on; nothing
  // while a file is written already.
  void start(const std::string& label);
  void stop();
  void mark(const std::string& text, const std::string& who);

  // Nothing is taken any more, and what came until now is written out: waits for that, but not
  // longer than `patience`. False: the disk has not answered, and the destructor would wait for it.
  bool end(Nanos patience);

  RecorderState state() const;
  const std::string& folder() const noexcept;
  // A file is being written because somebody asked for it.
  bool asked() const noexcept;

 private:
  class Thread;
  std::unique_ptr<Thread> thread_;
};

// 1 to 40 letters, digits, '-' and '_'.
bool is_record_label(const std::string& label);

}  // namespace handrail
