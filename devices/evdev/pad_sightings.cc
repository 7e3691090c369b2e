#include "devices/evdev/pad_sightings.h"

#include <unistd.h>

#include <filesystem>

namespace handrail {

std::vector<Sighting> pad_sightings(EvdevKernel& kernel, const std::string& path,
                                    const std::string& input_folder, const PadWish& wish) {
  const bool named = !path.empty();
  std::vector<Sighting> out;
  for (const std::string& one : named ? std::vector{path} : gamepad_paths(input_folder)) {
    const auto opened = open_evdev(kernel, one, EvdevUse::kShare);
    if (!opened) {
      const bool there = std::filesystem::exists(std::filesystem::symlink_status(one));
      // Of those that nobody may read it is not known what they are: a name of udev's says it.
      if (named || one.ends_with(kJoystickEnding)) {
        out.push_back(sighting_of(one, there ? Readiness::kUnfinished : Readiness::kAbsent,
                                  opened.message()));
      }
      continue;
    }
    ::close(opened->fd);
    const std::string name(text_of(opened->name));
    if (wish.fits(*opened)) {
      out.push_back({one, Readiness::kReady, name + ", " + wish.kind(*opened), ""});
    } else if (named) {
      out.push_back({one, Readiness::kUnfinished, name + " " + wish.lacks,
                     std::string("name ") + wish.wanted + " in " + wish.option});
    }
  }
  if (out.empty()) out.push_back({input_folder, Readiness::kAbsent, wish.any, "plug one in"});
  return out;
}

}  // namespace handrail
