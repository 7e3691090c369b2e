#include "server/scene/text_io.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <vector>

#include "proto/field.pb.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"

namespace handrail {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

// Of what is said of an error, which may quote the file [bytes].
constexpr std::size_t kLongest = 1000;

// Keeps the first error only: the ones after it are mostly its consequences.
class FirstError : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int line, int column, const std::string& message) override {
    if (!text.empty()) return;
    at_line = std::max(line, 0);
    at_column = std::max(column, 0);
    text = message;
  }
  int at_line = 0;
  int at_column = 0;
  std::string text;
};

// The text between the n-th pair of double quotes, n from 0.
std::string quoted(const std::string& s, int n) {
  std::size_t start = s.find('"');
  for (; n > 0 && start != std::string::npos; --n) {
    start = s.find('"', start + 1);
    if (start != std::string::npos) start = s.find('"', start + 1);
  }
  if (start == std::string::npos) return {};
  const std::size_t end = s.find('"', start + 1);
  return end == std::string::npos ? std::string() : s.substr(start + 1, end - start - 1);
}

const Descriptor* descend(const Descriptor* type, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const FieldDescriptor* f = type == nullptr ? nullptr : type->FindFieldByName(name);
    type = f == nullptr ? nullptr : f->message_type();
  }
  return type;
}

std::string unknown_field_hint(const Descriptor* type, const std::string& name) {
  if (type == nullptr) return "no such field";
  for (const pb::Gone& gone : type->options().GetRepeatedExtension(pb::gone)) {
    if (gone.name() == name) return "no longer used; in its place: " + gone.instead();
  }
  std::vector<std::string> names;
  for (int i = 0; i < type->field_count(); ++i) names.push_back(type->field(i)->name());
  const std::string nearest = nearest_name(name, names);
  if (!nearest.empty()) return "no such field; did you mean '" + nearest + "'?";
  return "no such field; expected one of " + joined(names, ", ");
}

// The words that a boolean or an enumeration may be; none for other fields.
std::vector<std::string> words_of(const Descriptor* type, const std::string& name) {
  const FieldDescriptor* f = type == nullptr ? nullptr : type->FindFieldByName(name);
  if (f == nullptr) return {};
  if (f->type() == FieldDescriptor::TYPE_BOOL) return {"true", "false"};
  std::vector<std::string> words;
  for (int i = 0; f->enum_type() != nullptr && i < f->enum_type()->value_count(); ++i) {
    words.push_back(f->enum_type()->value(i)->name());
  }
  return words;
}

std::string is_none_of(const std::string& value, const std::vector<std::string>& words) {
  return value + " is not one of " + joined(words, ", ");
}

// The value that begins at `at`, behind the sign that asks for one; empty: none does.
std::string value_at(const std::string& text, std::size_t at) {
  const std::size_t before = at == 0 ? at : text.find_last_not_of(" \t\r\n", at - 1);
  if (at >= text.size() || before >= at || std::string(":[,").find(text[before]) > 2) return {};
  const bool is_quoted = text[at] == '"' || text[at] == '\'';
  if (!is_quoted) return text.substr(at, text.find_first_of(" \t\r\n,;]}>#", at) - at);
  const std::size_t last = text.find(text[at], at + 1);
  return text.substr(at, last == std::string::npos ? last : last + 1 - at);
}

}  // namespace

Status TextSource::load(const std::string& path, Message& out) {
  const Result<std::string> text = read_file(path, kMaxBytes);
  if (!text) return text.status();
  return parse(path, *text, out);
}

Status TextSource::parse(const std::string& place, std::string_view text, Message& out) {
  place_ = place;
  text_ = text;
  type_ = out.GetDescriptor();
  tree_ = std::make_unique<TextFormat::ParseInfoTree>();
  const google::protobuf::LogSilencer silence;
  FirstError error;
  TextFormat::Parser parser;
  parser.RecordErrorsTo(&error);
  parser.WriteLocationsTo(tree_.get());
  parser.SetRecursionLimit(16);
  if (!parser.ParseFromString(text_, &out)) {
    std::size_t offset = offset_of(error.at_line, error.at_column);
    const std::string why = explain(error.text, offset);
    return Status::error(position(offset) + shown(why, kLongest));
  }
  if (const auto problem = check_fields(out)) return error_at(*problem);
  return Status::ok();
}

Status TextSource::error_at(const FieldProblem& problem) const {
  TextFormat::ParseLocation best(0, 0);
  const TextFormat::ParseInfoTree* tree = tree_.get();
  const Descriptor* type = type_;
  for (std::size_t i = 0; i < problem.path.size() && tree != nullptr && type != nullptr;) {
    const std::size_t end = std::min(problem.path.find('.', i), problem.path.size());
    const std::string part = problem.path.substr(i, end - i);
    const std::size_t bracket = part.find('[');
    const FieldDescriptor* f = type->FindFieldByName(part.substr(0, bracket));
    if (f == nullptr) break;
    int index = -1;
    if (f->is_repeated()) {
      index = bracket == std::string::npos ? 0 : std::atoi(part.c_str() + bracket + 1);
    }
    TextFormat::ParseLocation here = tree->GetLocation(f, index);
    // A list in brackets is recorded as one field.
    if (here.line < 0 && index > 0) here = tree->GetLocation(f, 0);
    if (here.line < 0) break;
    best = here;
    type = f->message_type();
    tree = type == nullptr ? nullptr : tree->GetTreeForNested(f, index);
    i = end + 1;
  }
  return Status::error(position(offset_of(best.line, best.column)) +
                       shown(to_sentence(problem), kLongest));
}

// Byte offset of a tokenizer position: lines from 0, columns from 0 with tabs as 8 columns.
std::size_t TextSource::offset_of(int line, int column) const {
  std::size_t i = 0;
  for (; line > 0; --line) {
    const std::size_t end = text_.find('\n', i);
    if (end == std::string::npos) break;
    i = end + 1;
  }
  for (int c = 0; c < column && i < text_.size() && text_[i] != '\n'; ++i) {
    c += text_[i] == '\t' ? 8 - c % 8 : 1;
  }
  return i;
}

std::string TextSource::position(std::size_t offset) const {
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text_.size()));
  const auto line = 1 + std::count(text_.begin(), end, '\n');
  const auto start = std::find(std::make_reverse_iterator(end), text_.rend(), '\n').base();
  return place_ + ":" + std::to_string(line) + ":" + std::to_string(end - start + 1) + ": ";
}

// Turns the parser's message into ours, and moves `offset` from the token behind a name to the
// name.
std::string TextSource::explain(std::string message, std::size_t& offset) const {
  const TextPlace place = place_at(text_, offset);
  const Descriptor* type = descend(type_, place.open);
  const auto about = [&](const std::string& name, const std::string& what) {
    std::vector<std::string> path = place.open;
    if (!name.empty()) path.push_back(name);
    return path.empty() ? what : "field '" + joined(path, ".") + "': " + what;
  };
  const auto move_back_to = [&](const std::string& word) {
    const std::size_t found = word.empty() ? std::string::npos : text_.rfind(word, offset);
    if (found != std::string::npos) offset = found;
  };
  if (message.find("has no field named") != std::string::npos) {
    const std::string name = quoted(message, 1);
    move_back_to(name);
    return about(name, unknown_field_hint(type, name));
  }
  if (message.find("specified multiple times") != std::string::npos) {
    const std::string name = quoted(message, 0);
    move_back_to(name);
    return about(name, "given twice");
  }
  if (message.find("Unknown enumeration value") != std::string::npos) {
    const std::string name = quoted(message, 1);
    const std::string value = quoted(message, 0);
    move_back_to(value);
    return about(name, is_none_of(value, words_of(type, name)));
  }
  if (message.find("value for boolean field") != std::string::npos) {
    const std::string name = quoted(message, 0);
    const std::string value = quoted(message, 1);
    move_back_to(value);
    return about(name, is_none_of(value, words_of(type, name)));
  }
  const std::vector<std::string> words = words_of(type, place.field);
  const std::string value = words.empty() ? std::string() : value_at(text_, offset);
  if (!value.empty()) return about(place.field, is_none_of(value, words));
  if (message.empty()) message = "cannot be parsed";
  message.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(message.front())));
  while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
  if (message.size() >= 4 && message.compare(message.size() - 4, 4, "got:") == 0) {
    message += " the end of the file";
  }
  if (message.starts_with("expected identifier")) message.replace(9, 10, "a field's name");
  std::replace(message.begin(), message.end(), '\n', ' ');
  return about(place.field, message);
}

}  // namespace handrail
