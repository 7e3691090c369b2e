// What the mains of both daemons are.
#pragma once

#include <string>

#include "server/daemon/daemon_args.h"
#include "server/daemon/daemon_log.h"
#include "server/daemon/io_thread.h"
#include "server/daemon/run_daemon.h"

namespace handrail {

// Reads the command line, with `options` beside those of every daemon, and the configuration, and
// then does `run(config, check, log)`, check: only to see whether it would start. `load`: of the
// arguments, a Result. The exit code. To be called last in main.
template <typename Load, typename Run>
int daemon_main(int argc, char** argv, const std::string& program, const char* what_it_does,
                DaemonOptions options, Load load, Run run) {
  return run_daemon(program, [&] {
    const auto args = parse_daemon_args(argc, argv, options);
    if (const auto code = answer_at_once(args, program, what_it_does, options)) return *code;
    const auto config = load(*args);
    if (!config) return fail_start(program, config.message());
    // Standard output carries only the READY line.
    const DaemonLog log(program, kIoPriority);
    return run(*config, args->check, log);
  });
}

}  // namespace handrail
