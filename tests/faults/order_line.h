// Orders to a running emulator over its socket, a line each.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail::faults {

class OrderLine {
 public:
  OrderLine() = default;
  ~OrderLine();
  OrderLine(const OrderLine&) = delete;
  OrderLine& operator=(const OrderLine&) = delete;

  // False: nobody listens there yet.
  bool connect(const std::string& path);
  // The answer without its "ok"; an error has what the emulator said, or that it says nothing.
  Result<std::string> order(const std::string& line);

 private:
  int fd_ = -1;
};

}  // namespace handrail::faults
