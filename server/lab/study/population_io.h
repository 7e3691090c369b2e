// Reads and writes populations of simulated operators (proto/operators.proto).
#pragma once

#include <string>
#include <string_view>

#include "server/base/status.h"
#include "server/lab/study/population.h"

namespace handrail {

// Extension of population files, with the dot.
inline constexpr std::string_view kPopulationExtension = ".operators";

// The file a word stands for: itself when it has a slash or the extension, else the shipped
// population of that name. The error lists the folders searched.
Result<std::string> find_population(const std::string& word);

// Loads one file. Besides the ranges in operators.proto: every parameter of the table is given
// exactly once, by the file or by its base, within what the table allows, with low <= median <=
// high and a source; a fitted one has a low above 0. Errors are one line with file, line, column,
// field and what was expected.
Result<Population> load_population(const std::string& path);

// The same for text in memory, as if read from `path`.
Result<Population> parse_population(const std::string& path, std::string_view text);

// A file that reads back to the same bits, for a population read from one whose numbers were left
// alone or set to decimals of the file's unit. What is the base's is left to it. Keeps the comment
// at the file's head, no others.
std::string to_text(const Population& population);

}  // namespace handrail
