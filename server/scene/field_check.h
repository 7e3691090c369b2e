// Checks the values of any message against the ranges written beside its fields in the .proto.
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>

#include "server/model/field_problem.h"

namespace handrail {

// What is wrong with a message; nothing when it is sound.
using Problem = std::optional<FieldProblem>;

// The first field whose value breaks its range option: outside min and max, not finite, a wrong
// number of elements, missing though required, or a string that is not plain UTF-8 text.
Problem check_fields(const google::protobuf::Message& message);

// "field 'PATH': TEXT" in one line.
std::string to_sentence(const FieldProblem& problem);

}  // namespace handrail
