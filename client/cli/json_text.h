// Messages as JSON, field names as in the .proto.
#pragma once

#include <google/protobuf/message.h>

#include <string>

namespace handrail {

// With every field, also those at their defaults. `pretty` spreads it over lines, else one line.
// 64-bit integers are strings, as protobuf's JSON mapping has it.
std::string json_text(const google::protobuf::Message& message, bool pretty);

}  // namespace handrail
