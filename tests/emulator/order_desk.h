// Where orders come from: the standard input, or clients of a Unix socket.
#pragma once

#include <poll.h>

#include <functional>
#include <string>
#include <vector>

#include "server/base/status.h"

namespace handrail::emulator {

class OrderDesk {
 public:
  // `place`: "-" for the standard input, whose answers go to the error output; else the path of a
  // socket, which only this user may open; "": nobody orders anything.
  Status open(const std::string& place);
  OrderDesk() = default;
  ~OrderDesk();
  OrderDesk(const OrderDesk&) = delete;
  OrderDesk& operator=(const OrderDesk&) = delete;

  std::vector<pollfd> waits() const;
  // Takes what has come, after a poll of waits(), and gives each line's answer to who sent it.
  void serve(const std::vector<pollfd>& came,
             const std::function<std::string(const std::string& line)>& carry_out);

 private:
  struct Client {
    int in = -1, out = -1;
    std::string begun;  // a line whose end has not come
    bool gone = false;
  };
  void take(Client& client, const std::function<std::string(const std::string& line)>& carry_out);

  std::string path_;
  int listening_ = -1;
  std::vector<Client> clients_;
};

}  // namespace handrail::emulator
