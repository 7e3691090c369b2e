// handrail tool ...
#pragma once

#include "client/cli/command.h"
#include "proto/scene.pb.h"

namespace handrail {

// The tool that the options describe, checked as far as it can be without a master. The error names
// the option.
Result<pb::Tool> tool_from(pb::Tool::Kind kind, const Options& options);

ExitCode call_tool(pb::Tool::Kind kind, const Options& options, const Console& console);

template <pb::Tool::Kind kind>
ExitCode run_tool(const Options& options, const Console& console) {
  return call_tool(kind, options, console);
}

// One that the scene names.
ExitCode run_tool_call(const Options& options, const Console& console);

ExitCode run_tool_list(const Options& options, const Console& console);

ExitCode run_tool_off(const Options& options, const Console& console);

}  // namespace handrail
