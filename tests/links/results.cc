#include "tests/links/results.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace handrail::links {

std::string Results::path_of(const LinkCase& link) const {
  return fmt::format("{}/delay{:g}-jitter{:g}-loss{:g}{}-seed{}", folder_, link.delay_ms,
                     link.jitter_ms, 100.0 * link.loss, link.in_order ? "-in-order" : "",
                     link.seed);
}

std::optional<LinkFigures> Results::find(const LinkCase& link) const {
  std::ifstream file(path_of(link));
  std::ostringstream text;
  text << file.rdbuf();
  std::array<char, 128> commit{};
  Made made;
  LinkFigures f;
  int engaged = 0;
  unsigned long long violations = 0;
  const int read = std::sscanf(
      text.str().c_str(),
      "commit %127s\ndrive_s %lf strokes %d load %*f\nengaged %d after %lf holds %lf held %lf "
      "longest %lf ends %lf behind %lf speed %lf violations %llu",
      commit.data(), &made.drive_s, &made.strokes, &engaged, &f.after, &f.holds, &f.held,
      &f.longest, &f.ends, &f.behind, &f.speed, &violations);
  made.commit = commit.data();
  if (read != 12 || !(made == made_)) return std::nullopt;
  f.engaged = engaged != 0;
  f.violations = violations;
  return f;
}

Status Results::add(const LinkCase& link, const LinkFigures& f, double load) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  // Whole or not at all: it may be stopped just then.
  const std::string path = path_of(link), unfinished = path + ".new";
  std::ofstream(unfinished) << fmt::format(
      "commit {}\ndrive_s {:g} strokes {} load {:.2f}\nengaged {} after {:.4f} holds {:.4f} held "
      "{:.6f} longest {:.1f} ends {:.4f} behind {:.4f} speed {:.2f} violations {}\n",
      made_.commit, made_.drive_s, made_.strokes, load, f.engaged ? 1 : 0, f.after, f.holds, f.held,
      f.longest, f.ends, f.behind, f.speed, f.violations);
  std::filesystem::rename(unfinished, path, error);
  return error ? Status::error(path + ": " + error.message() + ", expected a folder to write in")
               : Status::ok();
}

}  // namespace handrail::links
