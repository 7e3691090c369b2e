#include "client/console/gateway/json_text.h"

#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/json_util.h>

#include "server/base/plain_text.h"

namespace handrail {

std::string json_text(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string out;
  // What is written by a program of ours has a mapping.
  (void)google::protobuf::util::MessageToJsonString(message, &out, options);
  return out;
}

Result<pb::FromPage> page_frame(std::string_view json) {
  const google::protobuf::LogSilencer silence;  // it would write about them itself
  pb::FromPage out;
  const auto read = google::protobuf::util::JsonStringToMessage(std::string(json), &out);
  if (!read.ok()) {
    return Status::error("no frame of handrail.console.v1: " +
                         shown(std::string(read.message()), 200));
  }
  if (out.frame_case() == pb::FromPage::FRAME_NOT_SET) {
    return Status::error("the frame is empty, expected one of request, hand, lead");
  }
  return out;
}

}  // namespace handrail
