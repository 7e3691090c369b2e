#include "client/cli/vector_text.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

#include "server/base/plain_text.h"
#include "server/scene/field_check.h"

namespace handrail {
namespace {

// The whole of `text` as one finite number; blanks around it and a leading + are fine.
std::optional<double> number_from(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (text.empty() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<Vec3> vector_from(const std::string& text) {
  Vec3 v;
  std::size_t start = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = text.find(',', start);
    if ((comma == std::string::npos) != (i == 2)) return std::nullopt;
    const std::size_t end = i == 2 ? text.size() : comma;
    const auto number = number_from(std::string_view(text).substr(start, end - start));
    if (!number) return std::nullopt;
    v[i] = *number;
    start = end + 1;
  }
  return v;
}

std::string opening(const std::string& flag, const std::string& text) {
  return flag + ": '" + text + "': ";
}

}  // namespace

Result<Vec3> parse_vector(const std::string& flag, const std::string& text, const std::string& unit,
                          const std::string& example) {
  if (const auto v = vector_from(text)) return *v;
  return Status::error(opening(flag, text) + "expected three numbers in " + unit + ", such as " +
                       example);
}

Result<Vec3> parse_direction(const std::string& flag, const std::string& text) {
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  if (text.size() == sign + 1) {
    const int axis = text[sign] - 'x';
    if (axis >= 0 && axis < 3) {
      Vec3 v = Vec3::Zero();
      v[axis] = text[0] == '-' ? -1.0 : 1.0;
      return v;
    }
  }
  const auto v = vector_from(text);
  if (!v) {
    return Status::error(opening(flag, text) +
                         "expected x, y or z with or without a sign, or three numbers such as "
                         "0,0.5,1");
  }
  if (v->stableNorm() < 1e-9)
    return Status::error(opening(flag, text) + "expected a direction with a length");
  return *v;
}

Result<double> parse_number(const std::string& flag, const std::string& text, double min,
                            double max, const std::string& unit) {
  const auto number = number_from(text);
  if (number && *number >= min && *number <= max) return *number;
  return Status::error(opening(flag, text) + "expected a number from " + number_text(min) + " to " +
                       number_text(max) + " " + unit);
}

}  // namespace handrail
