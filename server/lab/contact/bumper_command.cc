#include "server/lab/contact/bumper_command.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <utility>

#include "server/lab/console/console.h"
#include "server/lab/study/study_drawing.h"

namespace handrail {
namespace {

// Each form, and the force that its approach promises [N].
constexpr std::pair<BumperSettings::Form, double> kForms[] = {
    {BumperSettings::Form::kPublished, 0.0},
    {BumperSettings::Form::kDefault, 0.0},
    {BumperSettings::Form::kDefault, 200.0}};

}  // namespace

int run_bumper_command(const BumperCommand& command, const std::atomic<bool>& cancelled) {
  if (!command.figures.empty()) {
    if (Status s = make_folder(command.figures); !s) return complain(s, kFailed);
  }
  std::vector<BumperMap> maps;
  bool kept = true;
  Progress progress;
  for (const bool rig : {false, true}) {
    if (!command.arm.empty() && (command.arm == "rig") != rig) continue;
    for (const auto& pair : kForms) {
      const BumperSettings::Form form = pair.first;
      const double promise = pair.second;
      const bool published = form == BumperSettings::Form::kPublished;
      if (!command.form.empty() && (command.form == "published") != published) continue;
      BumperMapOptions options;
      options.form = form;
      options.promise = promise;
      options.rig = rig;
      options.noise = command.noise;
      options.threads = command.threads;
      options.cancelled = &cancelled;
      options.progress = [&](std::size_t done) {
        progress.show(fmt::format("{} arm, {}: {} cells", rig ? "rig's" : "rigid",
                                  published       ? "published form"
                                  : promise > 0.0 ? "default form with its approach slowed"
                                                  : "default form",
                                  done));
      };
      maps.push_back(run_bumper_map(options));
      if (maps.back().cells.empty()) return complain(Status::error("cancelled"), kCancelled);
      kept = kept && (published || keeps_all(maps.back()));
    }
  }
  progress.clear();
  const std::string text = command.json ? bumper_json(maps) : bumper_table(maps);
  std::fputs(text.c_str(), stdout);
  if (!command.figures.empty()) {
    if (Status s = draw_bumper(command.figures, maps); !s) return complain(s, kFailed);
  }
  return kept ? kDone : kFailed;
}

}  // namespace handrail
