#include "server/base/plain_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace handrail {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Length of the UTF-8 sequence at `i`; 0 when malformed, overlong, a surrogate or past U+10FFFF.
std::size_t sequence_length(std::string_view s, std::size_t i) {
  const auto at = [&](std::size_t k) { return static_cast<std::uint8_t>(s[k]); };
  const std::uint8_t lead = at(i);
  if (lead < 0x80) return 1;
  const std::size_t n = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || i + n > s.size()) return 0;
  for (std::size_t k = 1; k < n; ++k) {
    if ((at(i + k) & 0xC0) != 0x80) return 0;
  }
  const std::uint8_t second = at(i + 1);
  const bool bad = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second >= 0xA0) ||
                   (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second >= 0x90);
  return bad ? 0 : n;
}

// Length of the character at `i`; 0 when it is no UTF-8, or a control character.
std::size_t plain_length(std::string_view s, std::size_t i) {
  const auto c = static_cast<std::uint8_t>(s[i]);
  if (c < 0x20 || c == 0x7F) return 0;
  const std::size_t n = sequence_length(s, i);
  return c == 0xC2 && n == 2 && static_cast<std::uint8_t>(s[i + 1]) < 0xA0 ? 0 : n;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

// Reads text format just far enough to know names from values.
class PlaceScanner {
 public:
  void take(std::string_view s, std::size_t& i) {
    const char c = s[i];
    if (c == '#') {
      while (i < s.size() && s[i] != '\n') ++i;
    } else if (c == '"' || c == '\'') {
      for (++i; i < s.size() && s[i] != c && s[i] != '\n'; ++i) {
        if (s[i] == '\\') ++i;
      }
      ++i;
      after_colon_ = false;
    } else if (is_word(c)) {
      const std::size_t start = i;
      while (i < s.size() && is_word(s[i])) ++i;
      if (!after_colon_ && lists_ == 0) field_ = s.substr(start, i - start);
      after_colon_ = false;
    } else {
      take_sign(c);
      ++i;
    }
  }
  TextPlace place() const {
    TextPlace out;
    for (const Level& level : levels_) out.open.push_back(level.field);
    out.field = field_;
    return out;
  }

 private:
  struct Level {
    std::string field;
    int lists;
  };
  void take_sign(char c) {
    if (c == ':') after_colon_ = true;
    if (c == '[') ++lists_;
    if (c == ']') lists_ = std::max(0, lists_ - 1);
    if (c == '{' || c == '<') {
      levels_.push_back({field_, lists_});
      field_.clear();
      lists_ = 0;
      after_colon_ = false;
    }
    if ((c == '}' || c == '>') && !levels_.empty()) {
      field_ = levels_.back().field;
      lists_ = levels_.back().lists;
      levels_.pop_back();
    }
  }
  std::vector<Level> levels_;
  std::string field_;
  int lists_ = 0;
  bool after_colon_ = false;
};

}  // namespace

bool is_plain_text(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = text[i] == '\n' || text[i] == '\t' ? 1 : plain_length(text, i);
    if (n == 0) return false;
    i += n;
  }
  return true;
}

std::string shown(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = plain_length(text, i);
    out += n == 0 ? std::string_view("?") : text.substr(i, n);
    i += std::max<std::size_t>(n, 1);
  }
  if (out.size() <= most) return out;
  // Between two characters.
  const auto inside = [&out](std::size_t i) {
    return i < out.size() && (static_cast<std::uint8_t>(out[i]) & 0xC0) == 0x80;
  };
  std::size_t head = most / 2, tail = out.size() - most / 2;
  while (inside(head)) --head;
  while (inside(tail)) ++tail;
  return out.substr(0, head) + "..." + out.substr(tail);
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = word.size() / 3 + 2;
  if (word.empty() || word.size() > 100) return best;
  for (const std::string& name : candidates) {
    std::size_t distance = edit_distance(word, name);
    const std::size_t common = std::min(word.size(), name.size());
    if (common >= 2 && word.substr(0, common) == name.substr(0, common)) {
      distance = std::min<std::size_t>(distance, 1);
    }
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

TextPlace place_at(std::string_view text, std::size_t offset) {
  const std::string_view head = text.substr(0, std::min(offset, text.size()));
  PlaceScanner scanner;
  for (std::size_t i = 0; i < head.size();) scanner.take(head, i);
  return scanner.place();
}

std::string joined(const std::vector<std::string>& parts, const char* separator) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : separator) + part;
  return out;
}

std::string number_text(double value) {
  std::array<char, 32> buffer;
  // Everyday sizes without an exponent.
  const bool everyday = value == 0.0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e12);
  char* const last = buffer.data() + buffer.size();
  const auto end = everyday ? std::to_chars(buffer.data(), last, value, std::chars_format::fixed)
                            : std::to_chars(buffer.data(), last, value);
  return std::string(buffer.data(), end.ptr);
}

}  // namespace handrail
