// Where the files that come with the programs lie.
#pragma once

#include <string>
#include <vector>

namespace handrail {

// Folders that exist of: `source`, the one in the tree this was built from, and then
// share/handrail/`installed` beside the running program's own folder.
std::vector<std::string> shipped_folders(const std::string& source, const std::string& installed);

}  // namespace handrail
