#include "tests/lint/source_text.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

namespace handrail::lint {
namespace {

namespace fs = std::filesystem;

bool is_left_out(const std::string& folder) {
  return folder.empty() || folder[0] == '.' || starts_with(folder, "build") ||
         folder == "node_modules" || folder == "dist" || folder == "shots";
}

// Index just past the literal that starts at `i` with a quote; an unfinished one ends with the
// line.
std::size_t end_of_literal(const std::string& text, std::size_t i) {
  const char quote = text[i];
  for (++i; i < text.size() && text[i] != quote && text[i] != '\n'; ++i) {
    if (text[i] == '\\') ++i;
  }
  return std::min(i + 1, text.size());
}

std::size_t past(std::size_t found, std::size_t length, const std::string& text) {
  return found == std::string::npos ? text.size() : found + length;
}

// Index just past what starts at `i` and is not code; `i` itself if code starts there.
std::size_t end_of_non_code(const std::string& text, std::size_t i) {
  if (text.compare(i, 2, "//") == 0) return past(text.find('\n', i), 0, text);
  if (text.compare(i, 2, "/*") == 0) return past(text.find("*/", i + 2), 2, text);
  if (text.compare(i, 2, "R\"") == 0) {
    const std::size_t open = text.find('(', i);
    if (open == std::string::npos) return text.size();
    std::string close = text.substr(i + 1, open - i - 1) + "\"";
    close[0] = ')';
    return past(text.find(close, open), close.size(), text);
  }
  if (text[i] == '"') return end_of_literal(text, i);
  // A quote within a number separates digits.
  const bool in_number = i > 0 && std::isxdigit(static_cast<unsigned char>(text[i - 1])) != 0;
  if (text[i] == '\'' && !in_number) return end_of_literal(text, i);
  return i;
}

}  // namespace

bool starts_with(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

std::vector<File> files_below(const std::string& root, const std::vector<std::string>& endings) {
  std::vector<File> files;
  for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator();
       ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory()) {
      if (is_left_out(name)) it.disable_recursion_pending();
      continue;
    }
    const bool wanted = std::any_of(endings.begin(), endings.end(),
                                    [&](const std::string& e) { return ends_with(name, e); });
    if (!wanted) continue;
    std::ifstream in(it->path(), std::ios::binary);
    files.push_back({fs::relative(it->path(), root).generic_string(),
                     {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}});
  }
  std::sort(files.begin(), files.end(),
            [](const File& a, const File& b) { return a.path < b.path; });
  return files;
}

std::vector<std::string> includes_of(const std::string& text) {
  static const std::regex include(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"])re");
  std::vector<std::string> paths;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), include);
       it != std::sregex_iterator(); ++it) {
    paths.push_back((*it)[1]);
  }
  return paths;
}

std::string code_only(const std::string& text) {
  std::string code = text;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = end_of_non_code(text, i);
    for (std::size_t k = i; k < end; ++k) {
      if (code[k] != '\n') code[k] = ' ';
    }
    i = std::max(end, i + 1);
  }
  return code;
}

std::string cmake_only(const std::string& text) {
  return std::regex_replace(text, std::regex("#[^\n]*"), "");
}

}  // namespace handrail::lint
