// Messages as JSON, field names as in the .proto.
#pragma once

#include <google/protobuf/message.h>

#include <string>

namespace handrail {

// With every field, also those not set, at their defaults. `pretty` spreads it over lines, else one
// line. Counters (uint64) are numbers, exact up to 2^53. Hashes (fixed64) and numbers that are not
// finite are strings, as protobuf's JSON mapping has it.
std::string json_text(const google::protobuf::Message& message, bool pretty);

// The same with the fields that are set alone.
std::string json_of_set_fields(const google::protobuf::Message& message, bool pretty);

}  // namespace handrail
