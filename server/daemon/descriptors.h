// How many files and sockets the process may have open.
#pragma once

#include <cstddef>

namespace handrail {

// Asks for `wanted` descriptors, where a shell grants a thousand at first: as many of them as the
// system lets a process have, and never fewer than before. Not real-time safe.
void raise_descriptor_limit(std::size_t wanted);

}  // namespace handrail
