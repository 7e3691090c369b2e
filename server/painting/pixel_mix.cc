#include "server/painting/pixel_mix.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace handrail {
namespace {

// The least height of a triangle of colours: eight times kTolerance.
constexpr float kLeastHeight = 16.0f / 255.0f;

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
  Colour made;
  for (std::size_t k = 0; k < 3; ++k) made[k] = out.t * ca[k] + (1.0f - out.t) * cb[k];
  out.error = largest_difference(coded, made);
  return out;
}

float PixelMixer::largest_difference(const Colour& coded, const Colour& mixed) const noexcept {
  float out = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    out = std::max(out, std::abs((linear_ ? coded_of(mixed[k]) : mixed[k]) - coded[k]));
  }
  return out;
}

PixelMixer::PixelColour PixelMixer::pixel_of(const std::uint8_t* rgba) const noexcept {
  PixelColour out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.coded[k] = static_cast<float>(rgba[k]) / 255.0f;
    out.mixed[k] = decode_[rgba[k]];
  }
  return out;
}

Mixture PixelMixer::mixture_of(const std::uint8_t* rgba, const int* near,
                               int count) const noexcept {
  Mixture best;
  const float opaque = static_cast<float>(rgba[3]) / 255.0f;
  if (rgba[3] != 255 && transparent_ < 0) return best;
  const auto [coded, mixed] = pixel_of(rgba);
  for (int i = 0; i < count; ++i) {
    // With itself too: a colour over the transparent one.
    for (int k = opaque < 1.0f ? i : i + 1; k < count; ++k) {
      if (near[i] == transparent_ || near[k] == transparent_) continue;
      const Fit f = fit(coded, mixed, near[i], near[k]);
      // What is left of a difference once the pixel is composed.
      const float error = f.error * opaque;
      if (error >= best.error) continue;
      best.parts[0] = {near[i], opaque * f.t};
      best.parts[1] = {near[k], opaque * (1.0f - f.t)};
      if (opaque < 1.0f) best.parts[2] = {transparent_, 1.0f - opaque};
      best.error = error;
    }
  }
  return best;
}

Mixture PixelMixer::triangle(const Colour& coded, const Colour& mixed,
                             const std::array<int, 3>& of) const noexcept {
  const auto at = [&](std::size_t i) { return mixed_[static_cast<std::size_t>(of[i])]; };
  const Colour origin = at(2);
  const auto minus = [](Colour c, const Colour& from) {
    for (std::size_t k = 0; k < 3; ++k) c[k] -= from[k];
    return c;
  };
  const auto dot = [](const Colour& c, const Colour& d) {
    return c[0] * d[0] + c[1] * d[1] + c[2] * d[2];
  };
  const Colour u = minus(at(0), origin), v = minus(at(1), origin), p = minus(mixed, origin);
  const float uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), pu = dot(p, u), pv = dot(p, v);
  const float area_squared = uu * vv - uv * uv;
  const float longest_squared = std::max({uu, vv, uu + vv - 2.0f * uv});
  Mixture out;
  if (area_squared < kLeastHeight * kLeastHeight * longest_squared) return out;
  const float s = (pu * vv - pv * uv) / area_squared, t = (pv * uu - pu * uv) / area_squared;
  if (s < 0.0f || t < 0.0f || s + t > 1.0f) return out;
  out.parts = {{{of[0], s}, {of[1], t}, {of[2], 1.0f - s - t}}};
  Colour made = origin;
  for (std::size_t k = 0; k < 3; ++k) made[k] += s * u[k] + t * v[k];
  out.error = largest_difference(coded, made);
  return out;
}

Mixture PixelMixer::meeting_of(const std::uint8_t* rgba, const int* near,
                               int count) const noexcept {
  if (rgba[3] != 255) return {};
  Mixture best = mixture_of(rgba, near, count);
  const auto [coded, mixed] = pixel_of(rgba);
  for (int i = 0; i < count; ++i) {
    for (int k = i + 1; k < count; ++k) {
      for (int l = k + 1; l < count; ++l) {
        const std::array<int, 3> of{near[i], near[k], near[l]};
        if (std::find(of.begin(), of.end(), transparent_) != of.end()) continue;
        const Mixture m = triangle(coded, mixed, of);
        if (m.error < best.error) best = m;
      }
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
    const bool has_entry =
        m.parts[0].entry == entry || m.parts[1].entry == entry || entry == transparent_;
    if (has_entry && m.error < best.error) best = m;
  }
  return best;
}

std::array<std::uint8_t, 4> PixelMixer::rgba_of(const Mixture& m) const noexcept {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * value));
  };
  Colour sum{};
  float opaque = 0.0f;
  for (const Mixture::Part& part : m.parts) {
    if (part.entry < 0 || part.entry == transparent_) continue;
    opaque += part.share;
    for (std::size_t k = 0; k < 3; ++k) {
      sum[k] += part.share * mixed_[static_cast<std::size_t>(part.entry)][k];
    }
  }
  std::array<std::uint8_t, 4> out{};
  for (std::size_t k = 0; k < 3 && opaque > 0.0f; ++k) {
    const float value = std::min(sum[k] / opaque, 1.0f);
    out[k] = byte(linear_ ? coded_of(value) : value);
  }
  out[3] = byte(std::min(opaque, 1.0f));
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
  float open = 0.0f;
  for (const Mixture::Part& part : m.parts) {
    if (part.entry >= 0 && !is_wall(part.entry)) open += part.share;
  }
  return std::min(open, 1.0f);
}

int PixelMixer::most_of(const Mixture& m) const noexcept {
  return std::max_element(
             m.parts.begin(), m.parts.end(),
             [](const Mixture::Part& a, const Mixture::Part& b) { return a.share < b.share; })
      ->entry;
}

int PixelMixer::wall_of(const Mixture& m) const noexcept {
  Mixture::Part most;
  for (const Mixture::Part& part : m.parts) {
    if (part.entry >= 0 && is_wall(part.entry) && part.share > most.share) most = part;
  }
  return most.entry;
}

}  // namespace handrail
