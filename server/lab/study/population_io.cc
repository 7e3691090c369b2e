#include "server/lab/study/population_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

#include "proto/operators.pb.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/scene/shipped.h"
#include "server/scene/text_io.h"

namespace handrail {
namespace {

using Problem = std::optional<FieldProblem>;

const ParameterInfo* info_named(const std::string& name) {
  for (const ParameterInfo& info : operator_parameter_table()) {
    if (name == info.name) return &info;
  }
  return nullptr;
}

std::string unknown_name(const std::string& name) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : operator_parameter_table()) names.push_back(info.name);
  const std::string nearest = nearest_name(name, names);
  return "no parameter '" + name + "'" +
         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
}

Problem check_allowed(const char* field, double value, const ParameterInfo& info) {
  if (value >= info.least && value <= info.most) return std::nullopt;
  return FieldProblem{field, number_text(value) + " is outside the " + number_text(info.least) +
                                 " to " + number_text(info.most) + " that " + info.name +
                                 " can be"};
}

// One block; a problem's path is relative to it.
Problem range_from(const pb::Operators::Parameter& in, const ParameterInfo& info,
                   ParameterRange& out) {
  if (Problem p = check_allowed("low", in.low(), info)) return p;
  if (Problem p = check_allowed("high", in.high(), info)) return p;
  if (in.low() > in.median() || in.median() > in.high()) {
    return FieldProblem{"median", number_text(in.median()) + " is outside its bounds, " +
                                      number_text(in.low()) + " to " + number_text(in.high())};
  }
  if (in.fitted() && in.low() <= 0.0) {
    return FieldProblem{"low", "0, but a fitted parameter's is above 0"};
  }
  if (in.source().empty())
    return FieldProblem{"source", "empty, expected where the numbers are from"};
  out.field = info.field;
  out.name = info.name;
  out.unit = info.unit;
  out.median = in.median() * info.unit;
  out.spread = in.spread();
  out.low = in.low() * info.unit;
  out.high = in.high() * info.unit;
  out.fitted = in.fitted();
  out.source = in.source();
  return std::nullopt;
}

Problem population_from(const pb::Operators& in, Population& out);

// What the base gives, each at its place in the table. It has no base itself, so this ends.
Problem inherit(const std::string& base, std::vector<ParameterRange>& ranges) {
  if (base.empty()) return std::nullopt;
  const Result<std::string> file = find_population(base);
  if (!file) return FieldProblem{"base", file.message()};
  const Result<std::string> text = read_file(*file, TextSource::kMaxBytes);
  if (!text) return FieldProblem{"base", text.message()};
  TextSource source;
  pb::Operators message;
  if (Status status = source.parse(*file, *text, message); !status) {
    return FieldProblem{"base", status.message()};
  }
  if (!message.base().empty()) {
    return FieldProblem{"base", "'" + base + "' has a base, expected a population without"};
  }
  Population people;
  if (const Problem p = population_from(message, people)) {
    return FieldProblem{"base", source.error_at(*p).message()};
  }
  for (ParameterRange& range : people.parameters) {
    range.fitted = false;
    range.inherited = true;
    ranges[static_cast<std::size_t>(info_named(range.name) - operator_parameter_table().data())] =
        range;
  }
  return std::nullopt;
}

Problem population_from(const pb::Operators& in, Population& out) {
  out.name = in.name();
  out.description = in.description();
  out.base = in.base();
  if (out.name.empty()) return FieldProblem{"name", "empty"};
  const std::vector<ParameterInfo>& table = operator_parameter_table();
  std::vector<ParameterRange> ranges(table.size());
  if (Problem p = inherit(out.base, ranges)) return p;
  for (int i = 0; i < in.parameter_size(); ++i) {
    const pb::Operators::Parameter& one = in.parameter(i);
    const std::string path = "parameter[" + std::to_string(i) + "]";
    const ParameterInfo* info = info_named(one.name());
    if (info == nullptr) return FieldProblem{path + ".name", unknown_name(one.name())};
    ParameterRange& range = ranges[static_cast<std::size_t>(info - table.data())];
    if (range.field != nullptr && !range.inherited) {
      return FieldProblem{path + ".name", "'" + one.name() + "' is given twice"};
    }
    range.inherited = false;
    if (Problem p = range_from(one, *info, range)) {
      p->path = path + "." + p->path;
      return p;
    }
  }
  const bool screws = std::any_of(ranges.begin(), ranges.end(), [&](const ParameterRange& range) {
    return range.field != nullptr &&
           table[static_cast<std::size_t>(&range - ranges.data())].of_screws;
  });
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (ranges[i].field != nullptr || (table[i].of_screws && !screws)) continue;
    return FieldProblem{"parameter",
                        std::string(table[i].name) + " is missing, expected every one once"};
  }
  std::erase_if(ranges, [](const ParameterRange& range) { return range.field == nullptr; });
  out.parameters = std::move(ranges);
  return std::nullopt;
}

// The lines of `text` before anything but comments.
std::string head_comment(std::string_view text) {
  std::string out;
  while (text.starts_with('#')) {
    const std::size_t length = std::min(text.find('\n'), text.size() - 1) + 1;
    out += text.substr(0, length);
    text.remove_prefix(length);
  }
  return out;
}

// The shortest decimal that, times `unit`, gives the bits of `si`; the nearest if none does.
std::string in_unit(double si, double unit) {
  const double near = si / unit;
  std::array<char, 40> text;
  constexpr int kMostDigits = std::numeric_limits<double>::max_digits10;
  for (int digits = 0; digits < kMostDigits; ++digits) {
    std::snprintf(text.data(), text.size(), "%.*e", digits, near);
    const double value = std::strtod(text.data(), nullptr);
    if (value * unit == si) return number_text(value);
  }
  return number_text(near);
}

// Plain text as text format writes a string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? "\\n" : std::string(1, c);
  }
  return out + '"';
}

}  // namespace

Result<std::string> find_population(const std::string& word) {
  if (word.find('/') != std::string::npos || word.ends_with(kPopulationExtension)) return word;
  std::string searched;
  for (const std::string& folder : shipped_folders(HANDRAIL_LAB_LIBRARY, "lab")) {
    const std::string file = folder + "/" + word + std::string(kPopulationExtension);
    std::error_code error;
    if (std::filesystem::exists(file, error)) return file;
    searched += (searched.empty() ? "" : ", ") + folder;
  }
  return Status::error("population '" + word + "' not found in " + searched);
}

Result<Population> parse_population(const std::string& path, std::string_view text) {
  TextSource source;
  pb::Operators message;
  if (Status status = source.parse(path, text, message); !status) return status;
  Population population;
  if (const Problem problem = population_from(message, population)) {
    return source.error_at(*problem);
  }
  population.file = path;
  population.comment = head_comment(text);
  return population;
}

Result<Population> load_population(const std::string& path) {
  const Result<std::string> text = read_file(path, TextSource::kMaxBytes);
  if (!text) return text.status();
  return parse_population(path, *text);
}

std::string to_text(const Population& population) {
  std::string out = population.comment;
  out += "name: " + quoted(population.name) + "\n";
  out += "description: " + quoted(population.description) + "\n";
  if (!population.base.empty()) out += "base: " + quoted(population.base) + "\n";
  for (const ParameterRange& p : population.parameters) {
    if (p.inherited) continue;
    out += "\nparameter {\n  name: " + quoted(p.name) + "\n";
    out += "  median: " + in_unit(p.median, p.unit) + "  spread: " + number_text(p.spread);
    out += "  low: " + in_unit(p.low, p.unit) + "  high: " + in_unit(p.high, p.unit);
    out += p.fitted ? "  fitted: true\n" : "\n";
    out += "  source: " + quoted(p.source) + "\n}\n";
  }
  return out;
}

}  // namespace handrail
