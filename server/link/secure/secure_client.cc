#include "server/link/secure/secure_client.h"

#include <algorithm>
#include <utility>

#include "server/link/secure/record.h"

namespace handrail {

using State = DtlsChannel::State;

void SecureClient::set_trusted(TrustList trusted) {
  context_.set_trusted(std::move(trusted));
  if (session_ != nullptr && !context_.trusts(session_->peer().key)) session_.reset();
}

bool SecureClient::calls() const noexcept {
  const Nanos most = serves_ ? kUnanswered : kFarthest;
  return session_ == nullptr || (asking_ != kForever && now_ - asking_ > most);
}

Nanos SecureClient::patience() const noexcept {
  if (answered_) return kFarthest;
  const std::size_t rounds = silent_ / std::max<std::size_t>(addresses_.size(), 1);
  return std::min(kFirstPatience << std::min<std::size_t>(rounds, 8), kFarthest);
}

void SecureClient::tick(Nanos now) noexcept {
  now_ = now;
  if (attempt_ == nullptr && calls() && !addresses_.empty() && now >= not_before_) {
    tried_ = addresses_[next_address_++ % addresses_.size()];
    attempt_ = DtlsChannel::make(context_, socket_, tried_);
    heard_ = now;
    answered_ = false;
    ++counts_.attempts;
  }
  if (attempt_ == nullptr) return;
  attempt_->tick();
  if (attempt_->state() == State::kHandshake && now - heard_ > patience()) {
    failed(DtlsChannel::Problem::kNoAnswer);
  }
  settle();
}

void SecureClient::failed(DtlsChannel::Problem problem) noexcept {
  using Problem = DtlsChannel::Problem;
  const bool silent = problem == Problem::kNoAnswer;
  // One that did not answer is called again at once.
  if (!silent) not_before_ = now_ + kRefusedPause;
  const bool says_more = problem_ != Problem::kNone && problem_ != Problem::kNoAnswer;
  if (!silent || !says_more || unanswered_) {
    problem_ = problem;
    refused_ = attempt_->peer();
  }
  unanswered_ = silent;
  silent_ = answered_ ? 0 : silent_ + 1;
  attempt_.reset();
}

void SecureClient::settle() noexcept {
  if (attempt_ == nullptr || attempt_->state() == State::kHandshake) return;
  if (attempt_->state() == State::kOpen) {
    session_ = std::move(attempt_);
    since_ = now_;
    asking_ = kForever;
    serves_ = false;
    silent_ = 0;
    problem_ = DtlsChannel::Problem::kNone;
    unanswered_ = false;
    ++counts_.sessions;
    return;
  }
  failed(attempt_->problem());
}

std::optional<Transport::Arrival> SecureClient::receive(std::span<std::uint8_t> buffer) noexcept {
  const auto arrival = socket_.receive(wire_);
  if (!arrival) return std::nullopt;
  const auto bytes = std::span<const std::uint8_t>(wire_).first(arrival->size);
  const auto from = [&](const std::unique_ptr<DtlsChannel>& channel) {
    return channel != nullptr && channel->address() == arrival->from;
  };
  const bool record = is_records(bytes);
  if (record && from(attempt_) && !is_data(bytes)) {
    heard_ = now_;
    answered_ = true;
    (void)attempt_->take(bytes, arrival->from, buffer);
    settle();
    return Arrival{0, false, true};
  }
  if (record && from(session_)) {
    const std::size_t size = session_->take(bytes, arrival->from, buffer);
    if (size != 0) {
      asking_ = kForever;
      serves_ = true;
      return Arrival{size, true};
    }
    // Ended by the other side, in order: another one is made.
    if (session_->state() == State::kClosed) session_.reset();
    if (!is_data(bytes)) return Arrival{0, false, true};
  }
  ++counts_.strangers;
  return Arrival{0, false};
}

bool SecureClient::send(std::span<const std::uint8_t> bytes) noexcept {
  if (session_ == nullptr || !session_->send(bytes)) return false;
  if (asking_ == kForever) asking_ = now_;
  return true;
}

std::string_view SecureClient::peer_name() const noexcept {
  if (session_ == nullptr) return {};
  const Trusted* who = context_.trusted().find(session_->peer().key);
  return who == nullptr ? std::string_view() : std::string_view(who->name);
}

}  // namespace handrail
