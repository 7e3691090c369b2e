#include "server/link/secure/secure_client.h"

#include <algorithm>
#include <utility>

#include "server/link/secure/record.h"

namespace handrail {

using State = DtlsChannel::State;

void SecureClient::set_trusted(TrustList trusted) {
  context_.set_trusted(std::move(trusted));
  newer_at_ = now_;
  // An attempt may have looked at the list already, and not again before it opens.
  for (auto* channel : {&session_, &before_, &attempt_}) {
    if (*channel == nullptr || !(*channel)->peer().shown) continue;
    if (!context_.trusts((*channel)->peer().key)) channel->reset();
  }
}

Status SecureClient::set_own(const OwnKey& key, const std::optional<OwnKey>& next) {
  newer_at_ = now_;
  return context_.set_own(key, next);
}

bool SecureClient::wants_newer() const noexcept {
  if (session_ == nullptr) return false;
  const Trusted* who = context_.trusted().find(session_->peer().key);
  return session_->own() != context_.newest_own() ||
         (who != nullptr && who->newest() != session_->peer().key);
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
  if (attempt_ == nullptr && !addresses_.empty()) {
    const bool calling = calls();
    if (now >= (calling ? not_before_ : newer_at_) && (calling || wants_newer())) begin(calling);
  }
  if (attempt_ == nullptr) return;
  attempt_->tick();
  if (attempt_->state() == State::kHandshake && now - heard_ > patience()) {
    failed(DtlsChannel::Problem::kNoAnswer);
  }
  settle();
}

void SecureClient::begin(bool calling) noexcept {
  using Own = SecureContext::Own;
  beside_ = !calling;
  if (calling) tried_ = addresses_[next_address_++ % addresses_.size()];
  attempt_ = DtlsChannel::make(context_, socket_, beside_ ? session_->address() : tried_,
                               beside_ || try_next_ ? Own::kNext : Own::kKey);
  heard_ = now_;
  answered_ = false;
  ++counts_.attempts;
}

void SecureClient::failed(DtlsChannel::Problem problem) noexcept {
  using Problem = DtlsChannel::Problem;
  newer_at_ = now_ + kNewerKeyPause;
  if (beside_) {
    attempt_.reset();
    return;
  }
  const bool silent = problem == Problem::kNoAnswer;
  if (!silent) try_next_ = problem == Problem::kWeAre && context_.has_next() && !try_next_;
  // One that may want our next key is called again at once, and so is one that did not answer.
  if (!silent && try_next_) return attempt_.reset();
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
    newer_at_ = now_ + kNewerKeyPause;
    const bool newer = session_ == nullptr || attempt_->own() != session_->own() ||
                       attempt_->peer().key != session_->peer().key;
    if (beside_ && !newer) return attempt_.reset();
    before_ = std::move(session_);
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
      if (!std::exchange(serves_, true)) {
        begun_ = SessionKeys{session_->own(), session_->peer().key};
        before_.reset();
      }
      return Arrival{size, true};
    }
    // Ended by the other side, in order: another one is made.
    if (session_->state() == State::kClosed) session_.reset();
    if (!is_data(bytes)) return Arrival{0, false, true};
  }
  if (record && from(before_)) {
    if (const std::size_t size = before_->take(bytes, arrival->from, buffer); size != 0) {
      return Arrival{size, true};
    }
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
