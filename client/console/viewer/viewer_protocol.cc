#include "client/console/viewer/viewer_protocol.h"

#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/base/plain_text.h"
#include "server/record/mcap/mcap_bytes.h"
#include "server/record/mcap/message_schema.h"

namespace handrail {
namespace {

// Opcodes.
constexpr char kMessageData = 1, kTime = 2, kPlaybackState = 5;
constexpr std::uint8_t kPlaybackRequest = 3;
constexpr std::size_t kLongestId = 256;  // of a request; SDK's are of 36 bytes

// By protobuf's mapping with lowerCamelCase, and lists that are empty.
std::string viewer_json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string out;
  // What is written by a program of ours has a mapping.
  (void)google::protobuf::util::MessageToJsonString(message, &out, options);
  return out;
}

pb::ViewerTime viewer_time(Nanos calendar) {
  pb::ViewerTime out;
  out.set_sec(static_cast<std::uint32_t>(calendar / kSecond));
  out.set_nsec(static_cast<std::uint32_t>(calendar % kSecond));
  return out;
}

template <typename Number>
void add_number(std::string& out, Number number) {
  for (std::size_t i = 0; i < sizeof(number); ++i) {
    out += static_cast<char>(number >> (8 * i) & 0xff);
  }
}

}  // namespace

std::string server_info_text(const std::string& version, const std::string& session,
                             const std::optional<ViewerRange>& range) {
  pb::ViewerServerInfo info;
  info.set_op("serverInfo");
  info.set_name("handrail-console " + version);
  info.set_session_id(session);
  if (!range) return viewer_json(info);
  info.set_name("handrail-console " + version + ", a recording");
  info.add_capabilities("time");
  info.add_capabilities("playbackControl");
  *info.mutable_data_start_time() = viewer_time(range->begins);
  *info.mutable_data_end_time() = viewer_time(range->ends);
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

std::string time_frame(Nanos calendar) {
  std::string out;
  out += kTime;
  add_number(out, static_cast<std::uint64_t>(calendar));
  return out;
}

Result<ViewerPlay> viewer_play(std::string_view frame) {
  McapTake take(frame);
  const auto opcode = take.number<std::uint8_t>();
  if (opcode != kPlaybackRequest) {
    return Status::error("opcode " + std::to_string(opcode) + ", expected 3: play or pause");
  }
  ViewerPlay out;
  const auto command = take.number<std::uint8_t>();
  out.speed = std::bit_cast<float>(take.number<std::uint32_t>());
  const bool seeks = take.number<std::uint8_t>() != 0;
  const auto to = take.number<std::uint64_t>();
  out.id = std::string(take.piece(take.number<std::uint32_t>()));
  if (take.failed()) return Status::error("a playback request that is not whole");
  if (command > 1) {
    return Status::error("playback command " + std::to_string(command) +
                         ", expected 0, play, or 1, pause");
  }
  if (!std::isfinite(out.speed)) return Status::error("playback speed: expected a number");
  if (out.id.size() > kLongestId || !is_plain_text(out.id)) {
    return Status::error("playback request id: expected text of at most " +
                         std::to_string(kLongestId) + " bytes");
  }
  out.playing = command == 0;
  constexpr auto kLast = static_cast<std::uint64_t>(std::numeric_limits<Nanos>::max());
  if (seeks) out.seek = static_cast<Nanos>(std::min(to, kLast));
  return out;
}

std::string playback_frame(const PlayState& state, Nanos calendar, bool by_seek,
                           const std::string& id) {
  constexpr char kPlaying = 0, kPaused = 1, kEnded = 3;
  std::string out;
  out += kPlaybackState;
  out += state.is == PlayState::Is::kPlaying  ? kPlaying
         : state.is == PlayState::Is::kPaused ? kPaused
                                              : kEnded;
  add_number(out, static_cast<std::uint64_t>(calendar));
  add_number(out, std::bit_cast<std::uint32_t>(static_cast<float>(state.speed)));
  out += static_cast<char>(by_seek);
  add_number(out, static_cast<std::uint32_t>(id.size()));
  out += id;
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
