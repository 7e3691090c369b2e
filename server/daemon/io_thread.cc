#include "server/daemon/io_thread.h"

#include <spdlog/spdlog.h>

namespace handrail {

void DaemonNews::serve(IoServer& server, const std::string& ready_line,
                       const ControlThread& control) {
  spdlog::info("{} thread: {}", control.name, control.realtime.report);
  ready_.make(ready_line);
  notice_.ready();
  const RealtimeGrant io = enter_realtime(kIoPriority);
  spdlog::info("IO thread: {}", io.report);
  const std::string advice = realtime_advice({control.realtime, io});
  if (!advice.empty()) spdlog::warn("{}", advice);
  const auto end = [&] {
    notice_.stopping();
    control.request_stop();
  };
  server.run({end, control.finished, [this](Nanos now, bool runs) { notice_.tick(now, runs); },
              control.realtime, io});
}

}  // namespace handrail
