// The tree's rules as functions of one file: each returns its violations, "path: what is wrong".
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/lint/source_text.h"

namespace handrail::lint {

using Violations = std::vector<std::string>;

// Which folder a path belongs to: "server/base", "server/lab/cell", "devices" for files right
// there.
std::string folder_of(const std::string& path);

// Whether files of the folder of `path` may include (or link) `folder`. False also for a folder
// that is not in the table.
bool may_use(const std::string& path, const std::string& folder);
bool is_in_table(const std::string& folder);

Violations include_direction(const File& source);
// handrail_library(...) in a folder's CMakeLists.txt links only what the folder may include.
Violations link_direction(const File& cmake);
// base includes the standard library, the system and Eigen only.
Violations base_dependencies(const File& source);
// The pure folders have no clock, thread, lock, stream, log or socket.
Violations pure_folders(const File& source);
// spdlog in .cc files of daemons, client and devices; never in a header.
Violations logging(const File& source);
// Asio in transports, drivers, servers, the client's API and mains.
Violations networking(const File& source);
// Headers that take seconds to compile, in at most two files each.
Violations heavy_headers(const std::vector<File>& sources);
// At most 400 lines.
Violations file_size(const File& source);
// At most 40 files in a folder, of every kind; a folder inside it is another one.
Violations folder_size(const std::vector<File>& files);
// Neither -ffast-math nor -march=native.
Violations build_options(const File& cmake);
// A page's links, and the project's paths it writes in `quotes`, exist as `there` says. A path with
// a capital letter for a part, as in `server/NAME.h`, is an example, unless its file is a page.
Violations dead_links(const File& page, const std::function<bool(const std::string& path)>& there);
// Every test body has an assertion, or calls a helper whose name says that it asserts.
Violations assertions(const File& test);

}  // namespace handrail::lint
