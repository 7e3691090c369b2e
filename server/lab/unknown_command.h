// A word on the command line that is no command, and what may have been meant.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/base/plain_text.h"

namespace handrail {

// `App`: CLI11's, which few files include. Names the first of `words` that is no command of `app`,
// or of the command before it, and the nearest that is one, or all; also all where one is missing.
// Empty when nothing is wrong.
template <typename App>
std::string unknown_command(const App& app, std::span<char* const> words) {
  const auto subs = app.get_subcommands([](const App*) { return true; });
  if (subs.empty() || (!words.empty() && words[0][0] == '-')) return {};
  const std::string word = words.empty() ? "" : words[0];
  std::vector<std::string> names;
  std::string known;
  for (const App* sub : subs) {
    if (sub->get_name() == word) return unknown_command(*sub, words.subspan(1));
    names.push_back(sub->get_name());
    known += (known.empty() ? "" : ", ") + sub->get_name();
  }
  if (words.empty()) return "expected a command: " + known + " (see handrail-lab --help)";
  const std::string nearest = nearest_name(word, names);
  return "no command '" + word + "'" +
         (nearest.empty() ? "; there are " + known : "; did you mean '" + nearest + "'?");
}

}  // namespace handrail
