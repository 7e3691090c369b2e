// Small pure helpers on text: what a user's file may hold, and what the user may have meant.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace handrail {

// True for valid UTF-8 without control characters other than newline and tab.
bool is_plain_text(std::string_view text);

// Text from a file or a stranger as a message may have it: one line of plain text, '?' for each
// byte of anything else, without its middle where it is longer than `most` bytes.
std::string shown(std::string_view text, std::size_t most = 60);

// The candidate most like `word` (edit distance, or one the start of the other); empty when none is
// near enough to be what was meant.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

std::string joined(const std::vector<std::string>& parts, const char* separator);

// The shortest decimal text that reads back as `value`.
std::string number_text(double value);

// Where in a protobuf text file a byte stands: the names of the enclosing messages, outermost
// first, and the field begun last in the innermost (empty: none yet).
struct TextPlace {
  std::vector<std::string> open;
  std::string field;
};
TextPlace place_at(std::string_view text, std::size_t offset);

}  // namespace handrail
