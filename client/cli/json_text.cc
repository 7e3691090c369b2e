#include "client/cli/json_text.h"

#include <google/protobuf/util/json_util.h>

namespace handrail {

std::string json_text(const google::protobuf::Message& message, bool pretty) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  options.add_whitespace = pretty;
  std::string out;
  const auto status = google::protobuf::util::MessageToJsonString(message, &out, options);
  if (!status.ok()) return "{}";
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

}  // namespace handrail
