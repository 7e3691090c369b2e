#include "client/cli/keys_command.h"

#include <charconv>
#include <ctime>
#include <string>

#include "server/base/plain_text.h"
#include "server/keys/once_links.h"
#include "server/keys/web_place.h"

namespace handrail {
namespace {

// Time to bring a link to who is to open it [min].
constexpr int kUsualMinutes = 10, kMostMinutes = 24 * 60;

OnceLinks own_links() { return OnceLinks(own_keys().path()); }

// Minutes and seconds of `seconds`, for people.
std::string span_text(std::int64_t seconds) {
  if (seconds >= 3600) return std::to_string(seconds / 3600) + " h";
  if (seconds >= 60) return std::to_string(seconds / 60) + " min";
  return std::to_string(seconds) + " s";
}

const char* state_of(const OnceLink& link, std::int64_t now) {
  return link.used != 0 ? "used" : now < link.until ? "open" : "over";
}

}  // namespace

ExitCode run_keys_link(const Options& o, const Console& console) {
  const auto role = parse_role(*o.word);
  if (role != Role::kOperator && role != Role::kObserver) {
    return complain(console, "keys link: '" + shown(*o.word) +
                                 "': expected operator (may drive) or observer (may only look)");
  }
  int minutes = kUsualMinutes;
  if (o.minutes) {
    const char* end = o.minutes->data() + o.minutes->size();
    const auto [at, error] = std::from_chars(o.minutes->data(), end, minutes);
    if (error != std::errc() || at != end || minutes < 1 || minutes > kMostMinutes) {
      return complain(console, "keys link: --for " + shown(*o.minutes) +
                                   ": expected minutes, a whole number of 1 to " +
                                   std::to_string(kMostMinutes));
    }
  }
  const auto place = WebPlace::load(own_keys().path());
  if (!place) return refuse_keys(console, place.message());
  const auto made = own_links().make(*role, minutes * 60, std::time(nullptr));
  if (!made) return refuse_keys(console, made.message());
  console.err << "link " << made->link.id << ", good once and for " << minutes << " min, as "
              << role_text(*role)
              << ". The browser warns that it does not know the certificate; its SHA-256 "
                 "fingerprint begins\n"
              << fingerprint_start(place->certificate) << ", and is there as a whole\n"
              << fingerprint(place->certificate) << '\n';
  console.out << place->url() << "?once=" << made->token << '\n';
  return kExitDone;
}

ExitCode run_keys_links(const Options& o, const Console& console) {
  const std::int64_t now = std::time(nullptr);
  const auto links = own_links().list(now);
  if (!links) return refuse_keys(console, links.message());
  if (o.json) {
    console.out << "[";
    const char* before = "";
    for (const OnceLink& link : *links) {
      console.out << std::exchange(before, ",\n ") << R"({"id": ")" << link.id << R"(", "role": ")"
                  << role_text(link.role) << R"(", "state": ")" << state_of(link, now)
                  << R"(", "made": )" << link.made << R"(, "until": )" << link.until
                  << R"(, "used": )" << link.used << "}";
    }
    console.out << "]\n";
    return kExitDone;
  }
  if (links->empty()) console.err << "there are no links: `handrail keys link ROLE` makes one\n";
  for (const OnceLink& link : *links) {
    const std::string state = state_of(link, now);
    console.out << link.id << "  " << role_text(link.role) << "  "
                << (state == "used"   ? "used " + span_text(now - link.used) + " ago"
                    : state == "open" ? "open for " + span_text(link.until - now)
                                      : "over, never used")
                << '\n';
  }
  return kExitDone;
}

ExitCode run_keys_unlink(const Options& o, const Console& console) {
  const auto done = own_links().remove(*o.word, std::time(nullptr));
  if (!done) return refuse_keys(console, done.message());
  console.out << *done << "; pages that it let in end within two seconds\n";
  return kExitDone;
}

}  // namespace handrail
