// A vector as a message's list of numbers.
#pragma once

#include <google/protobuf/repeated_field.h>

#include "server/base/spatial.h"

namespace handrail {

// Appends v in units of `unit`.
inline void set_vector(google::protobuf::RepeatedField<double>* out, const Vec3& v, double unit) {
  for (int i = 0; i < 3; ++i) out->Add(v[i] / unit);
}

}  // namespace handrail
