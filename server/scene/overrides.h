// Single fields of a scene or configuration set from the command line: --set KEY=VALUE.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/status.h"
#include "server/scene/field_check.h"

namespace handrail {

// KEY names a field of a message, nested ones with dots: "guidance.delta_mm". VALUE is as in the
// text format, without quotes: a number, an enum's name, true or false, text; lists with commas.
struct Override {
  std::string key;
  std::string value;
};

// From the words behind --set. The error names the word that is no KEY=VALUE.
Result<std::vector<Override>> parse_overrides(const std::vector<std::string>& words);

// What is wrong with a whole message, if anything.
using MessageCheck = std::function<std::optional<FieldProblem>(const google::protobuf::Message&)>;

// Sets what the keys name, `prefix` taken off, in order, then asks `check` about the whole. Works
// on any message that passes `check` as it is. A list is replaced; an empty VALUE empties it. On an
// error `message` is left alone, and the error is one line about the override at fault, such as
// "--set guidance.delta_mm=abc: 'abc' is not a number".
Status set_fields(google::protobuf::Message& message, const std::vector<Override>& overrides,
                  std::string_view prefix = {}, const MessageCheck& check = check_fields);

}  // namespace handrail
