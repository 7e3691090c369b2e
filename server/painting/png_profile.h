// The colour profile inside a PNG file, as far as walls need it.
#pragma once

#include <string_view>

namespace handrail {

// True for a file with an ICC profile that says its values are light, not coded: what GIMP writes
// for images of linear precision, and libpng does not tell. False for anything else or unreadable.
bool has_linear_profile(std::string_view png);

}  // namespace handrail
