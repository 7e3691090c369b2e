#include "server/scene/json_io.h"

#include <google/protobuf/util/json_util.h>

namespace handrail {
namespace {

std::string to_json(const google::protobuf::Message& message, bool pretty, bool unset) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = unset;
  options.add_whitespace = pretty;
  std::string out;
  const auto status = google::protobuf::util::MessageToJsonString(message, &out, options);
  if (!status.ok()) return "{}";
  while (!out.empty() && out.back() == '\n') out.pop_back();
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
