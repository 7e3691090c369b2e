#include "server/scene/overrides.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/text_format.h>

#include <memory>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

// What the name behind `before` (empty or ending in a dot) should have been.
std::string unknown_field(const Descriptor& type, const std::string& before,
                          const std::string& name) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.push_back(type.field(i)->name());
  const std::string nearest = nearest_name(name, names);
  const std::string no_field = "no field '" + before + name + "'";
  if (!nearest.empty()) return no_field + "; did you mean '" + before + nearest + "'?";
  return no_field + "; expected one of " + joined(names, ", ");
}

std::string wrong_value(const FieldDescriptor& f, const std::string& value) {
  const std::string is_not = "'" + value + "' is ";
  switch (f.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT: return is_not + "not a number";
    case FieldDescriptor::CPPTYPE_BOOL: return is_not + "neither true nor false";
    case FieldDescriptor::CPPTYPE_ENUM: {
      std::vector<std::string> names;
      for (int i = 0; i < f.enum_type()->value_count(); ++i) {
        names.push_back(f.enum_type()->value(i)->name());
      }
      return is_not + "not one of " + joined(names, ", ");
    }
    case FieldDescriptor::CPPTYPE_UINT32:
    case FieldDescriptor::CPPTYPE_UINT64: return is_not + "not a whole number, 0 or more";
    default: return is_not + "not a whole number";
  }
}

// Sets or, in a list, appends.
bool take_value(Message& m, const FieldDescriptor& f, const std::string& value) {
  const google::protobuf::Reflection& r = *m.GetReflection();
  if (f.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    f.is_repeated() ? r.AddString(&m, &f, value) : r.SetString(&m, &f, value);
    return true;
  }
  const google::protobuf::LogSilencer silence;
  return TextFormat::Parser().ParseFieldValueFromString(value, &f, &m);
}

// Returns what is wrong; empty when the value was taken.
std::string take(Message& m, const FieldDescriptor& f, const std::string& value) {
  if (!f.is_repeated()) return take_value(m, f, value) ? "" : wrong_value(f, value);
  m.GetReflection()->ClearField(&m, &f);
  if (value.empty()) return {};
  for (const std::string& part : split(value, ',')) {
    if (!take_value(m, f, part)) return wrong_value(f, part);
  }
  return {};
}

// The same for a key from `root` on.
std::string set(Message& root, const std::string& key, const std::string& value) {
  const std::vector<std::string> names = split(key, '.');
  Message* m = &root;
  std::string before;
  for (std::size_t i = 0;; ++i) {
    const FieldDescriptor* f = m->GetDescriptor()->FindFieldByName(names[i]);
    if (f == nullptr) return unknown_field(*m->GetDescriptor(), before, names[i]);
    const bool is_last = i + 1 == names.size();
    const std::string here = "'" + before + names[i] + "'";
    if (f->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
      return is_last ? take(*m, *f, value) : here + " is a value, nothing is inside it";
    }
    if (f->is_repeated()) return here + " is a list of blocks, which cannot be set here";
    if (is_last) {
      return here + " is a block; name a field in it, such as " + key + "." +
             f->message_type()->field(0)->name();
    }
    before += names[i] + ".";
    m = m->GetReflection()->MutableMessage(m, f);
  }
}

// True for the path of the key's field or of an element of it.
bool is_at(const std::string& path, const std::string& key) {
  return path.starts_with(key) && (path.size() == key.size() || path[key.size()] == '[');
}

Status error_about(const Override& override, const std::string& why) {
  return Status::error("--set " + shown(override.key + "=" + override.value) + ": " +
                       shown(why, 1000));
}

}  // namespace

Result<std::vector<Override>> parse_overrides(const std::vector<std::string>& words) {
  std::vector<Override> out;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos) {
      return Status::error("--set " + shown(word) +
                           ": expected KEY=VALUE, such as guidance.stiffness_n_mm=0.4");
    }
    out.push_back({word.substr(0, equals), word.substr(equals + 1)});
  }
  return out;
}

Status set_fields(Message& message, const std::vector<Override>& overrides, std::string_view prefix,
                  const MessageCheck& check) {
  const std::unique_ptr<Message> changed(message.New());
  changed->CopyFrom(message);
  std::optional<FieldProblem> problem;
  const Override* at_fault = nullptr;
  for (const Override& override : overrides) {
    const std::string why = override.key.starts_with(prefix)
                                ? set(*changed, override.key.substr(prefix.size()), override.value)
                                : "the key does not begin with " + std::string(prefix);
    if (!why.empty()) return error_about(override, why);
    problem = check(*changed);
    if (!problem) at_fault = nullptr;
    if (problem && at_fault == nullptr) at_fault = &override;
  }
  if (problem) {
    for (const Override& override : overrides) {
      if (is_at(problem->path, override.key.substr(prefix.size()))) at_fault = &override;
    }
    const bool names_it = is_at(problem->path, at_fault->key.substr(prefix.size()));
    return error_about(*at_fault, names_it ? problem->text : to_sentence(*problem));
  }
  message.CopyFrom(*changed);
  return Status::ok();
}

}  // namespace handrail
