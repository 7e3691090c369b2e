#include "client/console/viewer/viewer_protocol.h"

#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/json_util.h>

#include "server/base/plain_text.h"
#include "server/record/mcap/message_schema.h"

namespace handrail {
namespace {

constexpr char kMessageData = 1;  // opcode

// By protobuf's mapping with lowerCamelCase, and lists that are empty.
std::string viewer_json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string out;
  // What is written by a program of ours has a mapping.
  (void)google::protobuf::util::MessageToJsonString(message, &out, options);
  return out;
}

template <typename Number>
void add_number(std::string& out, Number number) {
  for (std::size_t i = 0; i < sizeof(number); ++i) {
    out += static_cast<char>(number >> (8 * i) & 0xff);
  }
}

}  // namespace

std::string server_info_text(const std::string& version, const std::string& session) {
  pb::ViewerServerInfo info;
  info.set_op("serverInfo");
  info.set_name("handrail-console " + version);
  info.set_session_id(session);
  return viewer_json(info);
}

std::string status_text(ViewerLevel level, const std::string& message) {
  pb::ViewerStatus status;
  status.set_op("status");
  status.set_level(static_cast<std::uint32_t>(level));
  status.set_message(message);
  return viewer_json(status);
}

std::string advertise_text(const pb::ViewerAdvertise& channels) { return viewer_json(channels); }

pb::ViewerChannel viewer_channel(std::uint32_t id, const std::string& topic,
                                 const google::protobuf::Descriptor& type) {
  pb::ViewerChannel out;
  out.set_id(id);
  out.set_topic(topic);
  out.set_encoding("protobuf");
  out.set_schema_name(type.full_name());
  out.set_schema_encoding("protobuf");
  out.set_schema(schema_of(type));
  return out;
}

std::string data_frame(std::uint32_t subscription, Nanos calendar, std::string_view message) {
  std::string out;
  out.reserve(1 + sizeof(std::uint32_t) + sizeof(std::uint64_t) + message.size());
  out += kMessageData;
  add_number(out, subscription);
  add_number(out, static_cast<std::uint64_t>(calendar));
  out += message;
  return out;
}

Result<pb::FromViewer> viewer_frame(std::string_view json) {
  const google::protobuf::LogSilencer silence;  // it would write about them itself
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  pb::FromViewer out;
  const auto read = google::protobuf::util::JsonStringToMessage(std::string(json), &out, options);
  if (!read.ok()) {
    return Status::error("no message of the protocol: " + shown(std::string(read.message()), 200));
  }
  return out;
}

}  // namespace handrail
