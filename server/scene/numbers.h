// Lists of numbers in a message as vectors.
#pragma once

#include <google/protobuf/repeated_field.h>

#include "server/base/plane.h"
#include "server/base/spatial.h"

namespace handrail {

using Numbers = google::protobuf::RepeatedField<double>;

// Zero where the list has not just as many numbers: a field that was left out.
inline Vec3 vector_of(const Numbers& v) {
  return v.size() == 3 ? Vec3(v[0], v[1], v[2]) : Vec3::Zero();
}
inline Vec2 plane_vector_of(const Numbers& v) {
  return v.size() == 2 ? Vec2(v[0], v[1]) : Vec2::Zero();
}

}  // namespace handrail
