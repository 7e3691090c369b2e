// Library and card, as a probe sees them.
#pragma once

#include <vector>

#include "devices/comedi/comedi_card.h"
#include "devices/driver.h"

namespace handrail {

// What was found of a device that `error` says cannot be used: the row of the library, or rows of
// library and card.
std::vector<Sighting> comedi_sightings(const ComediPlace& place, const std::string& error);

// The row of a library that was loaded.
Sighting comedi_library_there(const ComediPlace& place);

// "device: ..." and "library: ..." of a block, where they are not the defaults; each with a space
// behind.
std::string comedi_place_block(const ComediPlace& place);

}  // namespace handrail
