#include "devices/melfa/r3_protocol.h"

#include <charconv>
#include <optional>
#include <vector>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr std::size_t kHead = 3;         // "QoK" [bytes]
constexpr std::size_t kStatusBytes = 4;  // two in hexadecimal [digits]
constexpr std::size_t kMostDigits = 9;   // fits an int

std::optional<int> whole_number(std::string_view text) {
  if (text.empty() || text.size() > kMostDigits) return std::nullopt;
  int value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    value = 10 * value + (c - '0');
  }
  return value;
}

std::optional<std::uint8_t> hex_byte(std::string_view digits) {
  std::uint8_t value = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stopped, error] = std::from_chars(digits.data(), end, value, 16);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

std::vector<std::string_view> fields_of(std::string_view body) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t at = body.find(';');
    out.push_back(body.substr(0, at));
    if (at == std::string_view::npos) return out;
    body.remove_prefix(at + 1);
  }
}

Status bad(const char* order, const std::string& what, std::string_view got) {
  return Status::error(std::string("the answer to ") + order + " has '" + shown(got) +
                       "', expected " + what);
}

Result<R3Status> status_of(const char* order, std::string_view field) {
  constexpr char kExpected[] = "four hexadecimal digits and the alarm's number";
  if (field.size() <= kStatusBytes) return bad(order, kExpected, field);
  const auto run = hex_byte(field.substr(0, 2));
  const auto stop = hex_byte(field.substr(2, 2));
  const auto alarm = whole_number(field.substr(kStatusBytes));
  if (!run || !stop || !alarm) return bad(order, kExpected, field);
  return R3Status{*run, *stop, *alarm};
}

char small(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

R3Reader::Said R3Reader::take(std::string_view piece) {
  text_.append(piece.substr(0, kMostR3Answer + 1 - text_.size()));
  if (text_.size() > kMostR3Answer) return Said::kTooLong;
  ended_ = ended_ || piece.find_first_of("\r\n") != std::string_view::npos;
  return ended_ ? Said::kWhole : Said::kMore;
}

Result<R3Answer> parse_r3_answer(std::string_view text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  const std::string_view rest = text.substr(line.size());
  const bool one = rest.find_first_not_of("\r\n") == std::string_view::npos;
  const char kind = line.size() < kHead ? '\0' : line[2];
  const bool done = line.starts_with("Qo") && (kind == 'K' || kind == 'k');
  const bool refused = line.starts_with("Qe") && (kind == 'R' || kind == 'r');
  if (text.size() > kMostR3Answer || !one || (!done && !refused)) {
    return Status::error("'" + shown(text) +
                         "' came, expected an answer that begins with QoK or QeR");
  }
  R3Answer out;
  out.done = done;
  out.alarm = kind == 'k' || kind == 'r';
  out.body = line.substr(kHead);
  for (const char c : out.body) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      return Status::error("'" + shown(text) + "' came, expected text without control characters");
    }
  }
  if (done) return out;
  // More fields may follow: of a program that cannot be read, the line.
  const std::string_view number = fields_of(out.body).front();
  const auto error = number.empty() ? std::optional<int>(0) : whole_number(number);
  if (!error) return Status::error("'" + shown(text) + "' came, expected a number after QeR");
  out.error = *error;
  return out;
}

Result<R3Status> parse_r3_dstate(std::string_view body) {
  return status_of("DSTATE", fields_of(body).front());
}

Result<R3State> parse_r3_state(std::string_view body) {
  constexpr std::size_t kRead = 5;    // fields
  constexpr int kMostOverride = 100;  // [%]
  const std::vector<std::string_view> fields = fields_of(body);
  if (fields.size() < kRead) return bad("STATE", "five fields or more, divided by ;", body);
  R3State out;
  out.program = fields[0];
  const auto line = whole_number(fields[1]);
  if (!line) return bad("STATE", "the number of a line", fields[1]);
  out.line = *line;
  const auto share = whole_number(fields[2]);
  if (!share || *share > kMostOverride) return bad("STATE", "an override of 0 to 100", fields[2]);
  out.override_percent = *share;
  const auto status = status_of("STATE", fields[4]);
  if (!status) return status.status();
  out.status = *status;
  return out;
}

bool same_program(std::string_view wanted, std::string_view told) {
  told = told.substr(0, told.find('.'));
  if (wanted.size() != told.size()) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (small(wanted[i]) != small(told[i])) return false;
  }
  return true;
}

}  // namespace handrail
