// Text of SVG files: numbers, escaping, and how wide a line of text is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace handrail::figure {

// A coordinate with at most two decimals, the same in every locale. Finite values only.
std::string number(double v);

// Text that may stand between tags and in quotes: the five special characters escaped; what XML
// does not allow, or is not UTF-8, replaced by U+FFFD.
std::string escape(std::string_view text);

// Estimated width of UTF-8 text in a sans-serif font of `size` pixels, rather too wide [px].
double text_width(std::string_view text, double size);

// Breaks text at newlines, and at spaces into lines no wider than `width` [px]; a longer word has
// its own line. At least one line.
std::vector<std::string> wrap(std::string_view text, double size, double width);

}  // namespace handrail::figure
