// What is wrong with one field of a scene or a configuration.
#pragma once

#include <string>

namespace handrail {

struct FieldProblem {
  std::string path;  // such as "tool[0].at_mm[2]"
  std::string text;  // such as "12 is outside 0 to 10 N/mm"
};

}  // namespace handrail
