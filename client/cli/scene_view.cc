#include "client/cli/scene_view.h"

#include <google/protobuf/text_format.h>

#include <iomanip>
#include <sstream>

#include "proto/field.pb.h"

namespace handrail {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

// True for a block that is there or, being left out, stands for its defaults.
bool has_values(const Message& m, const FieldDescriptor& f) {
  if (m.GetReflection()->HasField(m, &f)) return true;
  const google::protobuf::Descriptor& type = *f.message_type();
  if (&type == pb::Walls::descriptor()) return false;  // left out, there are none
  for (int i = 0; i < type.field_count(); ++i) {
    if (type.field(i)->options().GetExtension(pb::range).required()) return false;
  }
  return true;
}

// `all`: also the fields at their defaults.
void print_message(const Message& m, const std::string& prefix, bool all, std::ostream& out);

pb::Walls::Method method_of(WallMethod method) {
  switch (method) {
    case WallMethod::kPublished: return pb::Walls::PUBLISHED;
    case WallMethod::kExact: return pb::Walls::EXACT;
    case WallMethod::kSubpixel: break;
  }
  return pb::Walls::SUBPIXEL;
}

std::string value_text(const Message& m, const FieldDescriptor& f) {
  std::string text, one;
  if (!f.is_repeated()) {
    TextFormat::PrintFieldValueToString(m, &f, -1, &text);
    return text;
  }
  for (int i = 0; i < m.GetReflection()->FieldSize(m, &f); ++i) {
    TextFormat::PrintFieldValueToString(m, &f, i, &one);
    text.append(i > 0 ? ", " : "").append(one);
  }
  return text;
}

void print_field(const Message& m, const FieldDescriptor& f, const std::string& prefix, bool all,
                 std::ostream& out) {
  const google::protobuf::Reflection& r = *m.GetReflection();
  const std::string name = prefix + f.name();
  if (f.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
    if (!f.is_repeated()) {
      if (!has_values(m, f)) return;
      std::ostringstream inner;
      print_message(r.GetMessage(m, &f), name + ".", all || r.HasField(m, &f), inner);
      // An effect that a scene lists is there even when it says nothing more of it.
      const bool listed = inner.str().empty() && r.HasField(m, &f);
      out << (listed ? name + "\n" : inner.str());
      return;
    }
    for (int i = 0; i < r.FieldSize(m, &f); ++i) {
      print_message(r.GetRepeatedMessage(m, &f, i), name + "[" + std::to_string(i) + "].", false,
                    out);
    }
    return;
  }
  const bool is_set = f.is_repeated() ? r.FieldSize(m, &f) > 0 : r.HasField(m, &f);
  if (!is_set && !all) return;
  const bool empty = f.is_repeated() && !is_set;
  const std::string unit = empty ? std::string() : f.options().GetExtension(pb::range).unit();
  out << std::left << std::setw(35) << name << ' ' << (empty ? "-" : value_text(m, f))
      << (unit.empty() ? "" : " ") << unit << (is_set ? "" : "  (default)") << '\n';
}

void print_message(const Message& m, const std::string& prefix, bool all, std::ostream& out) {
  for (int i = 0; i < m.GetDescriptor()->field_count(); ++i) {
    print_field(m, *m.GetDescriptor()->field(i), prefix, all, out);
  }
}

}  // namespace

std::string scene_text(const pb::Scene& scene) {
  std::ostringstream out;
  print_message(scene, "", true, out);
  return out.str();
}

pb::Scene as_used(const pb::Scene& raw, const Scene& scene) {
  pb::Scene out = raw;
  // Which one is the default depends on how the walls are given.
  if (scene.walls) out.mutable_walls()->set_method(method_of(scene.walls->method));
  return out;
}

pb::Scene with_sections(pb::Scene scene) {
  const google::protobuf::Descriptor& type = *scene.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& f = *type.field(i);
    const bool section = !f.is_repeated() && f.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (section && has_values(scene, f)) scene.GetReflection()->MutableMessage(&scene, &f);
  }
  return scene;
}

}  // namespace handrail
