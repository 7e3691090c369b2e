#include "server/scene/json_io.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>

namespace handrail {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

// Takes the quotes off the 64-bit counters in what protobuf printed of a message. It goes by the
// types: a text in a field of the same name stays one.
class CountersAsNumbers {
 public:
  CountersAsNumbers(const std::string& json, const Descriptor& type) : json_(json) {
    value(&type, false);
  }
  const std::string& text() const { return out_; }

 private:
  bool ended() const { return at_ >= json_.size(); }
  void copy() { out_ += json_[at_++]; }
  // Copies up to the next of these; false at the end.
  bool copy_to(const char* stops) {
    const std::size_t stop = std::min(json_.find_first_of(stops, at_), json_.size());
    out_.append(json_, at_, stop - at_);
    at_ = stop;
    return !ended();
  }
  // What stands between quotes, which are left out.
  std::string quoted() {
    const std::size_t first = ++at_;
    while (!ended() && json_[at_] != '"') at_ += json_[at_] == '\\' ? 2 : 1;
    std::string out = json_.substr(first, at_ - first);
    ++at_;
    return out;
  }
  // An object of this type, if it is one, a list, or a single value. It begins at the next sign
  // that is no blank.
  void value(const Descriptor* type, bool counter) {
    while (!ended() && (json_[at_] == ' ' || json_[at_] == '\n')) copy();
    if (ended()) return;
    if (json_[at_] == '"') {
      const std::string text = quoted();
      out_ += counter ? text : '"' + text + '"';
    } else if (json_[at_] == '{') {
      copy();
      while (copy_to("\"}") && json_[at_] == '"') member(type);
      if (!ended()) copy();
    } else if (json_[at_] == '[') {
      copy();
      while (!ended() && json_[at_] != ']') {
        value(type, counter);
        copy_to(",]");
        if (!ended() && json_[at_] == ',') copy();
      }
      if (!ended()) copy();
    } else {
      copy_to(",]} \n");
    }
  }
  void member(const Descriptor* type) {
    const std::string name = quoted();
    out_ += '"' + name + '"';
    if (copy_to(":")) copy();
    const FieldDescriptor* field = type == nullptr ? nullptr : type->FindFieldByName(name);
    value(field == nullptr ? nullptr : field->message_type(),
          field != nullptr && field->type() == FieldDescriptor::TYPE_UINT64);
    copy_to(",}");
  }

  const std::string& json_;
  std::size_t at_ = 0;
  std::string out_;
};

std::string to_json(const google::protobuf::Message& message, bool pretty, bool unset) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = unset;
  options.add_whitespace = pretty;
  std::string out;
  const auto status = google::protobuf::util::MessageToJsonString(message, &out, options);
  if (!status.ok()) return "{}";
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return CountersAsNumbers(out, *message.GetDescriptor()).text();
}

}  // namespace

std::string json_text(const google::protobuf::Message& message, bool pretty) {
  return to_json(message, pretty, true);
}

std::string json_of_set_fields(const google::protobuf::Message& message, bool pretty) {
  return to_json(message, pretty, false);
}

}  // namespace handrail
