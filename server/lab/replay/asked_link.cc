#include "server/lab/replay/asked_link.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr double kLongestDelay = 5000.0;  // [ms], of stability across delay the longest claimed

Status wrong(const std::string& part) {
  return Status::error("--link: '" + shown(part) +
                       "', expected delay=MS,jitter=MS,loss=PERCENT, such as "
                       "delay=50,jitter=20,loss=10; 0 to 5000 ms, 0 to 100 %");
}

}  // namespace

Result<LinkWords> link_words(const std::string& text) {
  LinkWords out;
  std::istringstream in(text);
  std::string seen;
  for (std::string part; std::getline(in, part, ',');) {
    const auto equals = part.find('=');
    if (equals == std::string::npos) return wrong(part);
    const std::string key = part.substr(0, equals);
    if (seen.find(key + ",") != std::string::npos) return wrong(part);
    seen += key + ",";
    double value = 0.0;
    const char* first = part.data() + equals + 1;
    const char* last = part.data() + part.size();
    const auto [end, code] = std::from_chars(first, last, value);
    const double most = key == "loss" ? 100.0 : kLongestDelay;
    if (code != std::errc() || end != last || !(value >= 0.0 && value <= most)) return wrong(part);
    if (key == "delay") {
      out.delay = from_seconds(value * 1e-3);
    } else if (key == "jitter") {
      out.jitter = from_seconds(value * 1e-3);
    } else if (key == "loss") {
      out.loss = value / 100.0;
    } else {
      return wrong(part);
    }
  }
  if (seen.empty()) return wrong(text);
  return out;
}

void AskedLink::apply(Nanos now, bool anew, HapticInput& in) {
  if (in.slave_known && anew) {
    ++number_;
    const double late = random_.uniform(), lost = random_.uniform();
    const auto jitter = static_cast<Nanos>(late * static_cast<double>(words_.jitter));
    if (lost >= words_.loss) {
      under_way_.push_back({now - in.slave_age + 2 * words_.delay + jitter, number_, in.slave});
    }
  }
  for (const Heard& heard : under_way_) {
    if (heard.at > now || heard.number <= newest_) continue;
    newest_ = heard.number;
    heard_at_ = heard.at;
    state_ = heard.state;
  }
  std::erase_if(under_way_, [&](const Heard& heard) { return heard.at <= now; });
  in.slave_known = newest_ != 0;
  in.slave = state_;
  in.slave_age = heard_at_ == -kForever ? kForever : now - heard_at_;
  in.link.loop_age += 2 * words_.delay;
  in.link.received_of_100 =
      static_cast<int>(std::lround((1.0 - words_.loss) * in.link.received_of_100));
}

}  // namespace handrail
