#include "devices/comedi/comedi_sighting.h"

namespace handrail {

Sighting comedi_library_there(const ComediPlace& place) {
  return {place.library, Readiness::kReady, "libcomedi is there", ""};
}

std::vector<Sighting> comedi_sightings(const ComediPlace& place, const std::string& error) {
  if (const auto api = load_comedi(place.library); !api) {
    const bool old = api.message().find(": has no ") != std::string::npos;
    return {sighting_of(place.library, old ? Readiness::kUnfinished : Readiness::kAbsent,
                        api.message())};
  }
  const bool absent = error.find("No such file") != std::string::npos;
  Sighting card =
      sighting_of(place.device, absent ? Readiness::kAbsent : Readiness::kUnfinished, error);
  if (card.next.empty()) card.next = "sudo dmesg | grep comedi; comedi_board_info " + place.device;
  return {comedi_library_there(place), card};
}

std::string comedi_place_block(const ComediPlace& place) {
  std::string out;
  if (place.device != kComediDevice) out += "device: \"" + place.device + "\" ";
  if (place.library != kComediLibrary) out += "library: \"" + place.library + "\" ";
  if (!place.board.empty()) out += "board: \"" + place.board + "\" ";
  return out;
}

}  // namespace handrail
