// Pipes and terminals that take no more.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace handrail::test {

// Writes what the pipe or terminal takes now, without waiting.
inline void fill(int end) {
  const int own = ::open(("/proc/self/fd/" + std::to_string(end)).c_str(),
                         O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(own, 0);
  const std::string text(256, '.');
  for (std::size_t size = text.size(); size > 0;) {
    if (::write(own, text.data(), size) <= 0) size /= 2;
  }
  ::close(own);
}

}  // namespace handrail::test
