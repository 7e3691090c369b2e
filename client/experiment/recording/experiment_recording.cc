#include "client/experiment/recording/experiment_recording.h"

#include <algorithm>
#include <utility>

#include "proto/operator.pb.h"
#include "server/base/plain_text.h"
#include "server/base/time.h"

namespace handrail {
namespace {

constexpr std::size_t kLongestLabel = 40;  // as the master takes it
// A trial waits for it; a master that is there answers within milliseconds.
constexpr Nanos kRecordingAnswer = kSecond;

}  // namespace

std::string recording_label(const std::string& experiment, const std::string& subject) {
  std::string out = experiment + "-" + subject;
  std::replace(out.begin(), out.end(), '.', '-');
  out.resize(std::min(out.size(), kLongestLabel));
  return out;
}

bool is_recording_with(const std::string& label, const std::string& file) {
  return file.ends_with("-master-" + label + ".mcap");
}

// Between two trials the master may have been started anew: then the first call finds out.
Result<pb::Reply> ExperimentRecording::ask(const pb::Request& request) {
  const Result<pb::Reply> reply = client_.call(request, kRecordingAnswer);
  return reply ? reply : client_.call(request, kRecordingAnswer);
}

// Why it was not done; empty: it was.
std::string ExperimentRecording::order(const pb::Request& request) {
  const Result<pb::Reply> reply = ask(request);
  if (!reply) return reply.message();
  return reply->done() ? "" : reply->reason();
}

void ExperimentRecording::say_once(const std::string& text) {
  if (std::exchange(said_, text) != text) say_(text);
}

void ExperimentRecording::keep() {
  pb::Request look, begin;
  look.set_status(true);
  const Result<pb::Reply> reply = ask(look);
  own_ = false;
  if (!reply) return say_once("not recorded: " + reply.message());
  const pb::Status& now = reply->status();
  if (!now.has_recording()) {
    return say_once("not recorded: the master's configuration has no recording {}");
  }
  own_ = is_recording_with(label_, now.recording().file());
  if (!own_) {
    begin.mutable_record()->set_on(true);
    begin.mutable_record()->set_label(label_);
    const std::string refused = order(begin);
    if (!refused.empty()) return say_once("not recorded by this runner: " + refused);
    own_ = true;
  }
  say_once("recorded into " + shown(now.recording().folder(), 200) + ", label " + label_);
}

void ExperimentRecording::mark(const std::string& text) {
  pb::Request request;
  request.set_mark(text);
  const std::string refused = order(request);
  if (own_ && !refused.empty()) say_once("  not marked in the recording: " + refused);
}

void ExperimentRecording::end() {
  if (!std::exchange(own_, false)) return;
  pb::Request request;
  request.mutable_record()->set_on(false);
  (void)order(request);
}

}  // namespace handrail
