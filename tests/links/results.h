// What the cells have given, a file each: a run that is stopped goes on where it was.
#pragma once

#include <optional>
#include <string>

#include "server/base/status.h"
#include "server/lab/links/link_map.h"

namespace handrail::links {

// What a cell was measured with. Another one: it is measured again.
struct Made {
  std::string commit;  // of the build, without spaces; "unknown"
  double drive_s = 0.0;
  int strokes = 0;

  friend bool operator==(const Made&, const Made&) = default;
};

class Results {
 public:
  // The folder is made by the first add().
  Results(std::string folder, Made made) : folder_(std::move(folder)), made_(std::move(made)) {}

  // Of the same build, plan and seed; nothing: it has not been measured.
  std::optional<LinkFigures> find(const LinkCase& link) const;
  // `load`: how many programs waited for a core, in the mean of the last minute.
  Status add(const LinkCase& link, const LinkFigures& figures, double load) const;

 private:
  std::string path_of(const LinkCase& link) const;

  std::string folder_;
  Made made_;
};

}  // namespace handrail::links
