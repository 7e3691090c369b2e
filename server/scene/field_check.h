// Checks the values of any message against the ranges written beside its fields in the .proto.
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>

namespace handrail {

// What is wrong with one field.
struct FieldProblem {
  std::string path;  // such as "tool[0].at_mm[2]"
  std::string text;  // such as "12 is outside 0 to 10 N/mm"
};

// The first field whose value breaks its range option: outside min and max, not finite, a wrong
// number of elements, missing though required, or a string that is not plain UTF-8 text.
std::optional<FieldProblem> check_fields(const google::protobuf::Message& message);

// "field 'PATH': TEXT" in one line.
std::string to_sentence(const FieldProblem& problem);

// The shortest decimal text that reads back as `value`.
std::string number_text(double value);

}  // namespace handrail
