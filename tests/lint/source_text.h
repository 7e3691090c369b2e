// Reading the source tree as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace handrail::lint {

struct File {
  std::string path;  // relative to the root, with '/'
  std::string text;
};

// Every file below `root` whose name ends in one of `endings`, sorted by path. Hidden folders,
// build trees, and what npm and the page's tests put into the tree are left out.
std::vector<File> files_below(const std::string& root, const std::vector<std::string>& endings);

// Paths of #include directives, with brackets or quotes taken off, in order.
std::vector<std::string> includes_of(const std::string& text);

// `text` with the contents of comments, strings (raw ones too) and character literals blanked out;
// line breaks stay, so that line numbers do.
std::string code_only(const std::string& text);

// CMake text without comments.
std::string cmake_only(const std::string& text);

bool starts_with(std::string_view text, std::string_view start);
bool ends_with(std::string_view text, std::string_view end);

}  // namespace handrail::lint
