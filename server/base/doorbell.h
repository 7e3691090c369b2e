// One thread wakes another that waits for descriptors.
#pragma once

namespace handrail {

// A descriptor that becomes readable when somebody rings.
class Doorbell {
 public:
  Doorbell() noexcept;
  ~Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  // From any thread; several rings before an answer are one. Real-time safe: one system call that
  // never waits.
  void ring() const noexcept;
  // Takes the rings so far; true when there was one. Never waits.
  bool answer() const noexcept;
  // Readable while a ring is unanswered; -1: the machine had none left, and ringing does nothing.
  // Stays ours.
  int fd() const noexcept { return fd_; }

 private:
  int fd_;
};

}  // namespace handrail
