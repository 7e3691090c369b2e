#include "client/console/console_identity.h"

#include <utility>

#include "client/console/web_tls.h"
#include "server/keys/key_folder.h"

namespace handrail {

Result<ConsoleIdentity> ConsoleIdentity::of(const ConsoleArgs& args) {
  if (!args.encrypted) return ConsoleIdentity{};
  const KeyFolder folder(default_key_folder());
  const auto own = folder.load();
  if (!own)
    return Status::error("--listen " + args.address + ": it is encrypted: " + own.message());
  auto place = WebPlace::make(folder.path(), own->key, args.names);
  if (!place) return Status::error("--name: " + place.message());
  auto tls = web_tls(own->key, place->certificate);
  if (!tls) return tls.status();
  return ConsoleIdentity{std::move(*place), std::move(*tls)};
}

KeyFollower::KeyFollower(const ConsoleArgs& args)
    : args_(args), known_(KeyFolder(default_key_folder()).stamp()) {}

void KeyFollower::follow(const ConsoleIdentity& shown, Told told) {
  port_ = shown.place.port;
  if (args_.encrypted) shown_ = fingerprint(shown.place.certificate);
  told_ = std::move(told);
}

void KeyFollower::look() {
  // With a master on this computer, for browsers on this computer, no key counts.
  if (!args_.encrypted && args_.master.host.empty()) return;
  const auto looked =
      errand_.poll([args = args_, port = port_, known = known_, shown = shown_]() -> Result<Look> {
        Look out;
        // The stamp first: a change between the two is seen next time.
        out.stamp = KeyFolder(default_key_folder()).stamp();
        if (out.stamp == known) return out;
        out.identity = ConsoleIdentity::of(args);
        if (!args.encrypted || !out.identity) return out;
        if (fingerprint(out.identity->place.certificate) == shown) return out;
        out.identity->place.port = port;
        if (Status saved = out.identity->place.save(default_key_folder()); !saved) {
          out.identity = saved;
        }
        return out;
      });
  if (!looked) return;
  if (!*looked) return told_.problem(looked->message());
  if (std::exchange(known_, (*looked)->stamp) == (*looked)->stamp) return;
  told_.changed();
  const auto& identity = (*looked)->identity;
  if (!identity) return told_.problem(identity.message());
  if (!args_.encrypted) return;
  if (std::string now = fingerprint(identity->place.certificate); now != shown_) {
    shown_ = std::move(now);
    told_.shows(*identity);
  }
}

}  // namespace handrail
