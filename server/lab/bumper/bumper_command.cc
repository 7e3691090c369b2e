#include "server/lab/bumper/bumper_command.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "server/lab/console.h"
#include "server/lab/study/study_drawing.h"

namespace handrail {

int run_bumper_command(const BumperCommand& command, const std::atomic<bool>& cancelled) {
  if (!command.figures.empty()) {
    if (Status s = make_folder(command.figures); !s) return complain(s, kFailed);
  }
  std::vector<BumperMap> maps;
  Progress progress;
  for (const bool rig : {false, true}) {
    if (!command.arm.empty() && (command.arm == "rig") != rig) continue;
    for (const auto form : {BumperSettings::Form::kPublished, BumperSettings::Form::kDefault}) {
      const bool published = form == BumperSettings::Form::kPublished;
      if (!command.form.empty() && (command.form == "published") != published) continue;
      BumperMapOptions options;
      options.form = form;
      options.rig = rig;
      options.noise = command.noise;
      options.threads = command.threads;
      options.cancelled = &cancelled;
      options.progress = [&](std::size_t done) {
        progress.show(fmt::format("{} arm, {} form: {} cells", rig ? "rig's" : "rigid",
                                  published ? "published" : "default", done));
      };
      maps.push_back(run_bumper_map(options));
      if (maps.back().cells.empty()) return kCancelled;
    }
  }
  progress.clear();
  const std::string text = command.json ? bumper_json(maps) : bumper_table(maps);
  std::fputs(text.c_str(), stdout);
  if (command.figures.empty()) return kDone;
  const Status drawn = draw_bumper(command.figures, maps);
  return drawn ? kDone : complain(drawn, kFailed);
}

}  // namespace handrail
