#include "server/scene/field_check.h"

#include <array>
#include <charconv>
#include <cmath>

#include "proto/field.pb.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// Element `index` of a numeric field; -1 for a singular one.
double number_of(const Message& m, const FieldDescriptor& f, int index) {
  const Reflection& r = *m.GetReflection();
  const bool one = index < 0;
  switch (f.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return one ? r.GetDouble(m, &f) : r.GetRepeatedDouble(m, &f, index);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return static_cast<double>(one ? r.GetFloat(m, &f) : r.GetRepeatedFloat(m, &f, index));
    case FieldDescriptor::CPPTYPE_INT32:
      return one ? r.GetInt32(m, &f) : r.GetRepeatedInt32(m, &f, index);
    case FieldDescriptor::CPPTYPE_UINT32:
      return one ? r.GetUInt32(m, &f) : r.GetRepeatedUInt32(m, &f, index);
    case FieldDescriptor::CPPTYPE_INT64:
      return static_cast<double>(one ? r.GetInt64(m, &f) : r.GetRepeatedInt64(m, &f, index));
    case FieldDescriptor::CPPTYPE_UINT64:
      return static_cast<double>(one ? r.GetUInt64(m, &f) : r.GetRepeatedUInt64(m, &f, index));
    default: return 0.0;
  }
}

std::string check_number(double value, const pb::Range& range) {
  if (!std::isfinite(value)) return number_text(value) + " is not a finite number";
  const bool low = range.has_min() && value < range.min();
  const bool high = range.has_max() && value > range.max();
  if (!low && !high) return {};
  const std::string unit = range.has_unit() ? " " + range.unit() : "";
  if (range.has_min() && range.has_max()) {
    return number_text(value) + " is outside " + number_text(range.min()) + " to " +
           number_text(range.max()) + unit;
  }
  return number_text(value) + (low ? " is below " : " is above ") +
         number_text(low ? range.min() : range.max()) + unit;
}

std::optional<FieldProblem> check_value(const Message& m, const FieldDescriptor& f, int index,
                                        const pb::Range& range) {
  const Reflection& r = *m.GetReflection();
  std::string path = f.name();
  if (index >= 0) path.append("[").append(std::to_string(index)).append("]");
  if (f.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
    auto problem =
        check_fields(index < 0 ? r.GetMessage(m, &f) : r.GetRepeatedMessage(m, &f, index));
    if (problem) problem->path = path + (problem->path.empty() ? "" : "." + problem->path);
    return problem;
  }
  std::string text;
  if (f.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    text = is_plain_text(index < 0 ? r.GetString(m, &f) : r.GetRepeatedString(m, &f, index))
               ? ""
               : "not plain UTF-8 text";
  } else {
    text = check_number(number_of(m, f, index), range);
  }
  if (text.empty()) return std::nullopt;
  return FieldProblem{path, text};
}

std::optional<FieldProblem> check_field(const Message& m, const FieldDescriptor& f) {
  const Reflection& r = *m.GetReflection();
  const pb::Range& range = f.options().GetExtension(pb::range);
  if (!f.is_repeated()) {
    if (r.HasField(m, &f)) return check_value(m, f, -1, range);
    return std::nullopt;
  }
  const int size = r.FieldSize(m, &f);
  if (range.has_count() && size != 0 && size != static_cast<int>(range.count())) {
    return FieldProblem{f.name(), std::to_string(size) + (size == 1 ? " value" : " values") +
                                      ", expected " + std::to_string(range.count())};
  }
  for (int i = 0; i < size; ++i) {
    if (auto problem = check_value(m, f, i, range)) return problem;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FieldProblem> check_fields(const Message& message) {
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    if (auto problem = check_field(message, *type.field(i))) return problem;
  }
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& f = *type.field(i);
    if (!f.options().GetExtension(pb::range).required()) continue;
    const Reflection& r = *message.GetReflection();
    const bool given = f.is_repeated() ? r.FieldSize(message, &f) > 0 : r.HasField(message, &f);
    if (!given) return FieldProblem{f.name(), "missing, but required"};
  }
  return std::nullopt;
}

std::string to_sentence(const FieldProblem& problem) {
  return "field '" + problem.path + "': " + problem.text;
}

}  // namespace handrail
