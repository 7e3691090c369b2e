// The files of the page: a table of names made once, and nothing beside it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "client/console/gateway/web.h"
#include "server/base/status.h"

namespace handrail {

// Names are compared whole with those of the table, so that no path leads out of it.
class Site {
 public:
  // What lies directly in `folder` with a name of letters, digits, '.', '_' and '-' and a known
  // ending, read now; index.html is `/`. Other files are passed over. The error names the folder or
  // the file. Blocks.
  static Result<Site> read(const std::string& folder);
  // One page that says `why` there is no other.
  static Site without_page(const std::string& why);

  // The file of that target; a query is not part of its name. None: 404.
  std::optional<WebAnswer> find(std::string_view target) const;
  // A file of the gateway's own, such as the walls' picture.
  void put(const std::string& path, const std::string& type, SharedText body);
  std::size_t size() const noexcept { return files_.size(); }

 private:
  struct Entry {
    std::string type;
    SharedText body;
  };
  std::map<std::string, Entry, std::less<>> files_;
};

}  // namespace handrail
