#include "server/scene/json_io.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include <set>

namespace handrail {
namespace {

using Names = std::set<std::string>;

// Of all fields in it, at any depth, that count in 64 bits.
void add_counters(const google::protobuf::Descriptor& type, Names& seen, Names& names) {
  if (!seen.insert(type.full_name()).second) return;
  for (int i = 0; i < type.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *type.field(i);
    if (field.type() == google::protobuf::FieldDescriptor::TYPE_UINT64) names.insert(field.name());
    if (field.message_type() != nullptr) add_counters(*field.message_type(), seen, names);
  }
}

// "name": "12" becomes "name": 12. Within a text quotes are escaped: there is no other such place.
void unquote(const std::string& name, std::string& json) {
  const std::string key = '"' + name + "\":";
  for (std::size_t at = 0; (at = json.find(key, at)) != std::string::npos;) {
    at += key.size();
    const std::size_t open = json.find_first_not_of(' ', at);
    if (open == std::string::npos || json[open] != '"') continue;
    const std::size_t close = json.find('"', open + 1);
    if (close == std::string::npos) return;
    json.erase(close, 1).erase(open, 1);
  }
}

std::string to_json(const google::protobuf::Message& message, bool pretty, bool unset) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = unset;
  options.add_whitespace = pretty;
  std::string out;
  const auto status = google::protobuf::util::MessageToJsonString(message, &out, options);
  if (!status.ok()) return "{}";
  while (!out.empty() && out.back() == '\n') out.pop_back();
  Names seen, counters;
  add_counters(*message.GetDescriptor(), seen, counters);
  for (const std::string& name : counters) unquote(name, out);
  return out;
}

}  // namespace

std::string json_text(const google::protobuf::Message& message, bool pretty) {
  return to_json(message, pretty, true);
}

std::string json_of_set_fields(const google::protobuf::Message& message, bool pretty) {
  return to_json(message, pretty, false);
}

}  // namespace handrail
