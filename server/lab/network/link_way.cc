#include "server/lab/network/link_way.h"

#include <algorithm>

namespace handrail {

LinkWay::Store::Store(std::size_t count, std::size_t longest)
    : longest_(longest), bytes_(count * longest), labels_(count) {}

void LinkWay::Store::put(std::size_t slot, std::span<const std::uint8_t> bytes,
                         Label label) noexcept {
  label.size = std::min(bytes.size(), longest_);
  std::copy_n(bytes.begin(), label.size,
              bytes_.begin() + static_cast<std::ptrdiff_t>(slot * longest_));
  labels_[slot] = label;
}

std::span<const std::uint8_t> LinkWay::Store::bytes(std::size_t slot) const noexcept {
  return std::span(bytes_).subspan(slot * longest_, labels_[slot].size);
}

LinkWay::LinkWay(std::uint64_t seed, const WaySize& size)
    : size_(size),
      random_(seed),
      replay_random_(seed ^ 0x7e91a7ULL),
      bit_random_(seed ^ 0xb175ULL),
      slots_(size.under_way + size.socket_queue, size.longest),
      queue_(size.socket_queue),
      history_(size.history, size.longest),
      damaged_(size.longest),
      taken_(2 * size.socket_queue) {
  free_.reserve(slots_.size());
  for (std::size_t i = slots_.size(); i > 0; --i)
    free_.push_back(static_cast<std::uint32_t>(i - 1));
  flights_.reserve(slots_.size());
}

Nanos LinkWay::travel(double draw) const noexcept {
  const auto spread = static_cast<Nanos>(static_cast<double>(faults.jitter) * (2.0 * draw - 1.0));
  return std::max<Nanos>(faults.delay + spread, 0);
}

bool LinkWay::pass_rate(std::size_t size, Nanos now, Nanos& start) noexcept {
  start = now;
  if (faults.rate_bps <= 0) return true;
  const Nanos free_at = std::max(rate_free_at_, now);
  if (free_at - now > faults.queue) return false;
  const auto bits = static_cast<std::int64_t>(8 * (size + size_.headers));
  start = rate_free_at_ = free_at + bits * kSecond / faults.rate_bps;
  return true;
}

void LinkWay::send(std::span<const std::uint8_t> bytes, Nanos now, std::size_t body) noexcept {
  const double lost = random_.uniform();
  const double turned = random_.uniform();
  const double delay = random_.uniform();
  const double doubled = random_.uniform();
  const double second_delay = random_.uniform();
  const double reordered = random_.uniform();
  const double corrupted = random_.uniform();

  bytes = bytes.first(std::min(bytes.size(), size_.longest));
  const std::uint64_t number = ++counters_.sent;
  history_.put(remembered_++ % history_.size(), bytes, {.number = number});

  bad_ = bad_ ? turned >= faults.burst_leave : turned < faults.burst_enter;
  Nanos start = now;
  if (bad_ || lost < faults.loss) {
    ++counters_.lost;
  } else if (!pass_rate(bytes.size(), now, start)) {
    ++counters_.overflow;
  } else {
    Nanos due = start + travel(delay);
    if (reordered < faults.reorder) {
      due += faults.reorder_by;
    } else {
      last_due_ = due = std::max(due, last_due_);
    }
    if (doubled < faults.duplicate) {
      ++counters_.duplicated;
      launch(bytes, number, Origin::kDuplicate, start + travel(second_delay));
    }
    if (corrupted < faults.corrupt && body < bytes.size()) {
      launch_corrupted(bytes, body, due);
    } else {
      launch(bytes, number, Origin::kGenuine, due);
    }
    damage_copies(bytes, body, due);
  }
  replay(now);
}

void LinkWay::inject(std::span<const std::uint8_t> bytes, Nanos now) noexcept {
  ++counters_.injected;
  launch(bytes, 0, Origin::kInjected, now);
}

std::span<const std::uint8_t> LinkWay::newest() const noexcept {
  return history_.bytes((remembered_ + history_.size() - 1) % history_.size());
}

// Old datagrams come with the delay of the way, jitter and all.
void LinkWay::replay(Nanos now) noexcept {
  for (double left = faults.replay; left > 0.0; left -= 1.0) {
    const double chance = replay_random_.uniform();
    const double which = replay_random_.uniform();
    const double delay = replay_random_.uniform();
    if (chance >= left) continue;
    const std::uint64_t known = std::min<std::uint64_t>(remembered_, history_.size());
    const auto back = static_cast<std::uint64_t>(which * static_cast<double>(known));
    const std::size_t slot = (remembered_ - 1 - back) % history_.size();
    ++counters_.replayed;
    launch(history_.bytes(slot), history_.label(slot).number, Origin::kReplay, now + travel(delay));
  }
}

// Each is counted as made twice, and as corrupted.
void LinkWay::damage_copies(std::span<const std::uint8_t> bytes, std::size_t body,
                            Nanos due) noexcept {
  for (double left = faults.corrupt_copies; left > 0.0 && body < bytes.size(); left -= 1.0) {
    if (left < 1.0 && bit_random_.uniform() >= left) continue;
    ++counters_.duplicated;
    launch_corrupted(bytes, body, due);
  }
}

void LinkWay::launch_corrupted(std::span<const std::uint8_t> bytes, std::size_t body,
                               Nanos due) noexcept {
  std::copy(bytes.begin(), bytes.end(), damaged_.begin());
  const std::uint64_t count = 1 + bit_random_.bits() % faults.corrupt_bits;
  std::uint64_t bit = 0;
  const auto flip = [&] { damaged_[body + bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8)); };
  for (std::uint64_t i = 0; i < count; ++i) {
    bit = bit_random_.bits() % (8 * (bytes.size() - body));
    flip();
  }
  // All were flipped back.
  if (std::equal(bytes.begin(), bytes.end(), damaged_.begin())) flip();
  ++counters_.corrupted;
  launch(std::span(damaged_).first(bytes.size()), counters_.sent, Origin::kCorrupt, due);
}

void LinkWay::launch(std::span<const std::uint8_t> bytes, std::uint64_t number, Origin origin,
                     Nanos due) noexcept {
  if (flights_.size() >= size_.under_way) {
    ++counters_.overflow;
    return;
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  slots_.put(slot, bytes, {.number = number, .origin = origin});
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
      ++counters_.overflow;
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
  const std::span<const std::uint8_t> bytes = slots_.bytes(slot);
  const std::size_t size = std::min(bytes.size(), out.size());
  std::copy_n(bytes.begin(), size, out.begin());
  ++counters_.delivered;
  if (taken_count_ < taken_.size()) {
    const Label& label = slots_.label(slot);
    taken_[taken_count_++] = {label.number, label.origin, now};
  }
  return size;
}

void LinkWay::flush() noexcept {
  for (; queued_ > 0; --queued_) {
    free_.push_back(queue_[first_]);
    first_ = (first_ + 1) % queue_.size();
  }
}

}  // namespace handrail
