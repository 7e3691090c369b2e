// What concerns the task of the person at the device, and nothing that moves: marks and prompts.
#include <spdlog/fmt/fmt.h>

#include "server/base/plain_text.h"
#include "server/master/order_desk.h"
#include "server/master/replies.h"

namespace handrail {
namespace {

constexpr std::size_t kLongestMark = 32, kLongestPrompt = 200;  // [bytes]

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
  reply(done());
}

void OrderDesk::prompt(const std::string& text, const ReplyTo& reply) {
  const std::string problem = problem_of("prompt", text, 0, kLongestPrompt);
  if (!problem.empty()) return reply(refused(problem));
  prompt_ = text;
  reply(done());
}

void OrderDesk::show_task(pb::Status& status) const {
  if (mark_.has_count()) *status.mutable_mark() = mark_;
  if (!prompt_.empty()) status.set_prompt(prompt_);
}

}  // namespace handrail
