// Which folder may use which.
#pragma once

#include <map>
#include <set>
#include <string>

namespace handrail::lint {

using Folders = std::set<std::string>;
using Table = std::map<std::string, Folders>;

// A folder's own files are always allowed; a folder inside it is another one. "devices" is the
// interfaces and the registry.
const Table& folder_table();

}  // namespace handrail::lint
