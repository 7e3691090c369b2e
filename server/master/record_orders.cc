// The order desk's work on what people say of a trial, and on writing it down.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "server/base/hand_move.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/master/order_desk.h"
#include "server/master/replies.h"

namespace handrail {
namespace {

// Who prompts says so again within this, or the prompt goes with them.
constexpr Nanos kPromptLasts = 5 * kSecond;
constexpr std::size_t kLongestMark = 200, kLongestPrompt = 200;  // [bytes]

// Why that text cannot be shown to others; empty: it can.
std::string problem_of(const char* what, const std::string& text, std::size_t least,
                       std::size_t most) {
  const bool one_line = is_plain_text(text) && text.find_first_of("\n\t") == std::string::npos;
  if (one_line && text.size() >= least && text.size() <= most) return {};
  return fmt::format("{}: '{}', expected {} to {} bytes of plain text in one line", what,
                     shown(text), least, most);
}

}  // namespace

void OrderDesk::mark(const std::string& text, const std::string& who, const ReplyTo& reply) {
  const std::string problem = problem_of("mark", text, 1, kLongestMark);
  if (!problem.empty()) return reply(refused(problem));
  mark_.set_count(mark_.count() + 1);
  mark_.set_text(text);
  mark_.set_by(who);
  mark_.set_time_s(to_seconds(now_));
  if (options_.recorder != nullptr) options_.recorder->mark(text, who);
  reply(done());
}

void OrderDesk::prompt(const pb::Request& wanted, const ReplyTo& reply) {
  const std::string problem = problem_of("prompt", wanted.prompt(), 0, kLongestPrompt);
  if (!problem.empty()) return reply(refused(problem));
  const auto& ball = wanted.ball_mm();
  const auto far = [](double mm) { return !(std::abs(mm) * kMm <= kFarthestHandMove); };
  if ((!ball.empty() && ball.size() != 2) || std::any_of(ball.begin(), ball.end(), far)) {
    return reply(refused(fmt::format("prompt: ball_mm: expected two numbers of at most {:g} mm",
                                     kFarthestHandMove / kMm)));
  }
  prompt_ = wanted.prompt();
  ball_mm_.assign(ball.begin(), ball.end());
  prompted_ = now_;
  reply(done());
}

void OrderDesk::show_task(pb::Status& status) const {
  if (mark_.has_count()) *status.mutable_mark() = mark_;
  if (prompt_.empty() || now_ - prompted_ >= kPromptLasts) return;
  status.set_prompt(prompt_);
  if (status.has_walls())
    status.mutable_walls()->mutable_ball_mm()->Assign(ball_mm_.begin(), ball_mm_.end());
}

void OrderDesk::record(const pb::RecordOrder& wanted, const std::string& who,
                       const ReplyTo& reply) {
  if (options_.recorder == nullptr) {
    return reply(
        refused("the master keeps nothing to record: add recording {} to its configuration, and "
                "start it anew"));
  }
  // One that a stop or a fault began ends by itself, and for this.
  const bool asked = options_.recorder->asked();
  const std::string file = options_.recorder->state().file;
  if (!wanted.on()) {
    if (file.empty()) return reply(refused("nothing is being recorded"));
    options_.recorder->stop();
    return reply(done());
  }
  if (asked) return reply(refused(file + " is being written: end that recording first"));
  if (wanted.has_label() && !is_record_label(wanted.label())) {
    return reply(refused("label: '" + shown(wanted.label()) +
                         "', expected 1 to 40 letters, digits, '-' and '_'"));
  }
  options_.recorder->start(wanted.label());
  options_.recorder->mark("recording", who);
  reply(done());
}

void OrderDesk::show_recording(pb::Status& status) const {
  if (options_.recorder == nullptr) return;
  const RecorderState state = options_.recorder->state();
  pb::RecordingStatus& out = *status.mutable_recording();
  out.set_folder(options_.record_folder);
  if (!state.file.empty()) out.set_file(state.file);
  if (!state.file.empty()) out.set_mb(static_cast<double>(state.bytes) * 1e-6);
  if (!state.problem.empty()) out.set_problem(state.problem);
  out.set_lost(state.lost);
}

}  // namespace handrail
