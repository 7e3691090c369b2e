// Loads the three daemons' configuration files.
//
// An empty path gives the defaults. Beyond the ranges in config.proto the loaders check what spans
// fields. Relative paths inside a file (recording, scene_path, link_socket) are taken from the
// file's own folder. Errors are one line with file, line, column, field, value and what was
// expected.
#pragma once

#include <string>

#include "proto/config.pb.h"
#include "server/base/status.h"

namespace handrail {

// `link`: a slave's host, or the address to listen at, and `operators`: the address to listen for
// them, in place of what the file says; empty: as it says.
Result<pb::MasterConfig> load_master_config(const std::string& path, const std::string& link = {},
                                            const std::string& operators = {});
Result<pb::SlaveConfig> load_slave_config(const std::string& path, const std::string& link = {});
Result<pb::RigConfig> load_rig_config(const std::string& path);

// Why `path` cannot name a Unix socket, and another whose path has `beside` bytes more; empty when
// it can.
std::string socket_path_problem(const std::string& path, std::size_t beside = 0);

}  // namespace handrail
