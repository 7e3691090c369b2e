#include "server/lab/cell/virtual_link.h"

#include <algorithm>

namespace handrail {
namespace {

constexpr std::size_t kHeaders = 28;  // of IP and UDP [bytes]

}  // namespace

LinkWay::LinkWay(std::uint64_t seed)
    : random_(seed),
      replay_random_(seed ^ 0x7e91a7ULL),
      bit_random_(seed ^ 0xb175ULL),
      slots_(kUnderWay + kSocketQueue),
      history_(kHistory) {
  for (std::size_t i = slots_.size(); i > 0; --i)
    free_.push_back(static_cast<std::uint32_t>(i - 1));
  flights_.reserve(slots_.size());
}

Nanos LinkWay::travel(double draw) const noexcept {
  const auto spread = static_cast<Nanos>(static_cast<double>(faults.jitter) * (2.0 * draw - 1.0));
  return std::max<Nanos>(faults.delay + spread, 0);
}

void LinkWay::send(std::span<const std::uint8_t> bytes, Nanos now) noexcept {
  const double lost = random_.uniform();
  const double turned = random_.uniform();
  const double delay = random_.uniform();
  const double doubled = random_.uniform();
  const double second_delay = random_.uniform();
  const double reordered = random_.uniform();
  const double corrupted = random_.uniform();

  Datagram datagram;
  datagram.size = std::min(bytes.size(), datagram.bytes.size());
  std::copy_n(bytes.begin(), datagram.size, datagram.bytes.begin());
  datagram.number = ++counters_.sent;
  remember(datagram);

  bad_ = bad_ ? turned >= faults.burst_leave : turned < faults.burst_enter;
  Nanos start = now;
  bool dropped = bad_ || lost < faults.loss;
  if (faults.rate_bps > 0 && !dropped) {
    const Nanos free_at = std::max(rate_free_at_, now);
    dropped = free_at - now > faults.queue;
    if (!dropped) {
      const auto bits = static_cast<std::int64_t>(8 * (datagram.size + kHeaders));
      start = rate_free_at_ = free_at + bits * kSecond / faults.rate_bps;
    }
  }
  if (!dropped) {
    Nanos due = start + travel(delay);
    if (reordered < faults.reorder) {
      due += faults.reorder_by;
    } else {
      last_due_ = due = std::max(due, last_due_);
    }
    if (doubled < faults.duplicate) {
      ++counters_.extra;
      launch(datagram, start + travel(second_delay));
    }
    if (corrupted < faults.corrupt && flip_bits(datagram)) ++counters_.corrupted;
    launch(datagram, due);
  } else {
    ++counters_.lost;
  }
  replay(now);
}

void LinkWay::inject(std::span<const std::uint8_t> bytes, Nanos now) noexcept {
  Datagram datagram;
  datagram.size = std::min(bytes.size(), datagram.bytes.size());
  std::copy_n(bytes.begin(), datagram.size, datagram.bytes.begin());
  datagram.authentic = false;
  launch(datagram, now);
}

std::span<const std::uint8_t> LinkWay::newest() const noexcept {
  const Datagram& last = history_[(remembered_ + kHistory - 1) % kHistory];
  return std::span(last.bytes).first(last.size);
}

void LinkWay::remember(const Datagram& datagram) noexcept {
  history_[remembered_++ % kHistory] = datagram;
}

// Old datagrams come with the delay of the way, jitter and all.
void LinkWay::replay(Nanos now) noexcept {
  for (double left = faults.replay; left > 0.0; left -= 1.0) {
    const double chance = replay_random_.uniform();
    const double which = replay_random_.uniform();
    const double delay = replay_random_.uniform();
    if (chance >= left) continue;
    const std::uint64_t known = std::min<std::uint64_t>(remembered_, kHistory);
    const auto back = static_cast<std::uint64_t>(which * static_cast<double>(known));
    ++counters_.extra;
    launch(history_[(remembered_ - 1 - back) % kHistory], now + travel(delay));
  }
}

bool LinkWay::flip_bits(Datagram& datagram) noexcept {
  if (datagram.size == 0) return false;
  const std::uint64_t count = 1 + bit_random_.bits() % 8;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t bit = bit_random_.bits() % (8 * datagram.size);
    datagram.bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
  }
  datagram.authentic = false;
  return true;
}

void LinkWay::launch(const Datagram& datagram, Nanos due) noexcept {
  if (flights_.size() >= kUnderWay) {
    ++counters_.lost;
    return;
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  slots_[slot] = datagram;
  flights_.push_back({due, launched_++, slot});
  std::push_heap(flights_.begin(), flights_.end(), later);
}

void LinkWay::advance(Nanos now) noexcept {
  while (!flights_.empty() && flights_.front().due <= now) {
    std::pop_heap(flights_.begin(), flights_.end(), later);
    const std::uint32_t slot = flights_.back().slot;
    flights_.pop_back();
    if (queued_ < queue_.size()) {
      queue_[(first_ + queued_++) % queue_.size()] = slot;
    } else {
      ++counters_.lost;
      free_.push_back(slot);
    }
  }
}

Nanos LinkWay::next_due() const noexcept {
  return flights_.empty() ? kForever : flights_.front().due;
}

std::size_t LinkWay::receive(std::span<std::uint8_t> out, Nanos now) noexcept {
  if (queued_ == 0) return 0;
  const std::uint32_t slot = queue_[first_];
  first_ = (first_ + 1) % queue_.size();
  --queued_;
  free_.push_back(slot);
  const Datagram& datagram = slots_[slot];
  const std::size_t size = std::min(datagram.size, out.size());
  std::copy_n(datagram.bytes.begin(), size, out.begin());
  ++counters_.delivered;
  if (taken_count_ < taken_.size()) {
    taken_[taken_count_++] = {datagram.number, datagram.authentic, now};
  }
  return size;
}

void LinkWay::flush() noexcept {
  for (; queued_ > 0; --queued_) {
    free_.push_back(queue_[first_]);
    first_ = (first_ + 1) % queue_.size();
  }
}

VirtualLink::VirtualLink(std::uint64_t seed) : to_slave_(seed), to_master_(~seed) {}

void VirtualLink::at(Nanos now) noexcept {
  now_ = now;
  to_slave_.advance(now);
  to_master_.advance(now);
}

Nanos VirtualLink::next_due() const noexcept {
  return std::min(to_slave_.next_due(), to_master_.next_due());
}

std::optional<Transport::Arrival> VirtualLink::End::receive(
    std::span<std::uint8_t> buffer) noexcept {
  const std::size_t size = in_.receive(buffer, now_);
  if (size == 0) return std::nullopt;
  return Arrival{size, true};
}

bool VirtualLink::End::send(std::span<const std::uint8_t> bytes) noexcept {
  out_.send(bytes, now_);
  return true;
}

}  // namespace handrail
