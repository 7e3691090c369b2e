#include "server/scene/pixel_mix.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace handrail {
namespace {

std::uint32_t key_of(const std::uint8_t* rgba) {
  std::uint32_t key = 0;
  std::memcpy(&key, rgba, 4);
  return key;
}

}  // namespace

PixelMixer::PixelMixer(const CoverageRules& rules)
    : linear_(rules.law == EdgeLaw::kLinear), transparent_(rules.transparent) {
  for (std::size_t i = 0; i < decode_.size(); ++i) {
    decode_[i] = mixing(static_cast<float>(i) / 255.0f);
  }
  for (const PaletteEntry& entry : rules.palette) {
    const std::array<std::uint8_t, 4> rgba{entry.rgb[0], entry.rgb[1], entry.rgb[2], 255};
    keys_.push_back(key_of(rgba.data()));
    mixed_.push_back({decode_[rgba[0]], decode_[rgba[1]], decode_[rgba[2]]});
    wall_.push_back(entry.wall);
  }
  const int n = static_cast<int>(keys_.size());
  for (int c = 0; c < n; ++c) {
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < a; ++b) ambiguous_ = ambiguous_ || is_between(c, a, b);
    }
  }
}

int PixelMixer::entry_of(const std::uint8_t* rgba) const noexcept {
  if (rgba[3] == 0) return transparent_;
  const std::uint32_t key = key_of(rgba);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (keys_[i] == key && static_cast<int>(i) != transparent_) return static_cast<int>(i);
  }
  return -1;
}

PixelMixer::Fit PixelMixer::fit(const Colour& coded, const Colour& mixed, int a,
                                int b) const noexcept {
  const Colour& ca = mixed_[static_cast<std::size_t>(a)];
  const Colour& cb = mixed_[static_cast<std::size_t>(b)];
  float along = 0.0f, length = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    along += (mixed[k] - cb[k]) * (ca[k] - cb[k]);
    length += (ca[k] - cb[k]) * (ca[k] - cb[k]);
  }
  Fit out;
  if (length > 0.0f) out.t = std::clamp(along / length, 0.0f, 1.0f);
  for (std::size_t k = 0; k < 3; ++k) {
    const float value = out.t * ca[k] + (1.0f - out.t) * cb[k];
    out.error = std::max(out.error, std::abs((linear_ ? coded_of(value) : value) - coded[k]));
  }
  return out;
}

Mixture PixelMixer::mixture_of(const std::uint8_t* rgba, const int* near,
                               int count) const noexcept {
  Mixture best;
  const float opaque = static_cast<float>(rgba[3]) / 255.0f;
  if (rgba[3] != 255 && transparent_ < 0) return best;
  Colour coded, mixed;
  for (std::size_t k = 0; k < 3; ++k) {
    coded[k] = static_cast<float>(rgba[k]) / 255.0f;
    mixed[k] = decode_[rgba[k]];
  }
  for (int i = 0; i < count; ++i) {
    // With itself too: a colour over the transparent one.
    for (int k = opaque < 1.0f ? i : i + 1; k < count; ++k) {
      if (near[i] == transparent_ || near[k] == transparent_) continue;
      const Fit f = fit(coded, mixed, near[i], near[k]);
      // What is left of a difference once the pixel is composed.
      const float error = f.error * opaque;
      if (error >= best.error) continue;
      best = {near[i], near[k], f.t, opaque, error};
    }
  }
  return best;
}

Mixture PixelMixer::strip_of(const std::uint8_t* rgba, const int* near, int count,
                             int entry) const noexcept {
  Mixture best;
  for (int i = 0; i < count; ++i) {
    if (is_wall(entry) == is_wall(near[i])) continue;
    const std::array<int, 2> pair{near[i], entry};
    const Mixture m = mixture_of(rgba, pair.data(), 2);
    const bool has_entry = m.a == entry || m.b == entry || entry == transparent_;
    if (has_entry && m.error < best.error) best = m;
  }
  return best;
}

std::array<std::uint8_t, 4> PixelMixer::rgba_of(const Mixture& m) const noexcept {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * value));
  };
  std::array<std::uint8_t, 4> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float value = m.t * mixed_[static_cast<std::size_t>(m.a)][k] +
                        (1.0f - m.t) * mixed_[static_cast<std::size_t>(m.b)][k];
    out[k] = byte(linear_ ? coded_of(value) : value);
  }
  out[3] = byte(m.opaque);
  return out;
}

bool PixelMixer::is_between(int c, int a, int b) const noexcept {
  if (c == a || c == b || c == transparent_ || a == transparent_ || b == transparent_) return false;
  const Colour& mixed = mixed_[static_cast<std::size_t>(c)];
  Colour coded = mixed;
  for (float& value : coded) value = linear_ ? coded_of(value) : value;
  return fit(coded, mixed, a, b).error <= kTolerance;
}

float PixelMixer::open_of(const Mixture& m) const noexcept {
  const auto open = [this](int entry) { return is_wall(entry) ? 0.0f : 1.0f; };
  const float over = m.opaque * (m.t * open(m.a) + (1.0f - m.t) * open(m.b));
  return m.opaque < 1.0f ? over + (1.0f - m.opaque) * open(transparent_) : over;
}

int PixelMixer::most_of(const Mixture& m) const noexcept {
  const float a = m.a == m.b ? 1.0f : m.t, most = std::max(a, 1.0f - a);
  if (m.opaque * most < 1.0f - m.opaque) return transparent_;
  return a >= 0.5f ? m.a : m.b;
}

int PixelMixer::wall_of(const Mixture& m) const noexcept {
  const float t = m.a == m.b ? 1.0f : m.t;
  float most = 0.0f;
  int wall = -1;
  const auto offer = [&](int entry, float share) {
    if (entry < 0 || share <= most || !is_wall(entry)) return;
    most = share;
    wall = entry;
  };
  offer(m.a, m.opaque * t);
  offer(m.b, m.opaque * (1.0f - t));
  offer(transparent_, 1.0f - m.opaque);
  return wall;
}

}  // namespace handrail
