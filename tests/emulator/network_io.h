// Networks by name or from a text file (proto/network.proto), and changes to them.
#pragma once

#include <string>
#include <string_view>

#include "server/base/status.h"
#include "tests/emulator/network.h"

namespace handrail::emulator {

// A name of known_networks(), or else the path of a file in protobuf text format. The error names
// the place in the file, or the names there are.
Result<NetworkPlan> load_network(const std::string& name_or_path);

// What `text` says of faults and edge is put into `plan`, the rest of them stays; its times are
// those of `text` alone. `place` stands for a file's name in errors; after an error `plan` is as it
// was.
Status change_network(const std::string& place, std::string_view text, NetworkPlan& plan);

}  // namespace handrail::emulator
