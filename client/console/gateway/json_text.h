// Messages as the JSON that pages read, and back.
#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <string_view>

#include "proto/console.pb.h"
#include "server/base/status.h"

namespace handrail {

// By protobuf's JSON mapping with the fields' own names.
std::string json_text(const google::protobuf::Message& message);

// The error says what is wrong, in one line of plain text. Unknown fields are an error: a page of
// another version says so and is not misunderstood.
Result<pb::FromPage> page_frame(std::string_view json);

}  // namespace handrail
