#include "client/cli/pair_command.h"

#include <string>
#include <utility>

#include "client/cli/keys_command.h"
#include "server/keys/pairing/pairing_socket.h"

namespace handrail {
namespace {

// The number of the encrypted link, which is UDP: one number to let through a firewall.
constexpr std::uint16_t kPairingPort = 47002;
// Time to read seven digits out and to type them. A code that nobody has used by then is forgotten.
constexpr Nanos kCodeLife = 60 * kSecond;

// Our key, as the other side is to trust it: the one that is there, or a new one.
Result<Trusted> own_entry(const Options& o, Roles roles, const Console& console) {
  const KeyFolder folder = own_keys();
  if (!folder.has_key()) {
    const auto made = folder.create(o.as.empty() ? computer_name() : o.as, roles);
    if (!made) return made.status();
    console.err << "made this user's key " << key_id(made->key.public_key()) << ", as "
                << made->name << ", " << roles_text(roles) << '\n';
    return made->entry();
  }
  const auto own = folder.load();
  if (!own) return own.status();
  if (!o.as.empty() && o.as != own->name) {
    return Status::error("this user's key is that of '" + own->name + "', not of '" + o.as +
                         "': leave --as out");
  }
  Trusted entry = own->entry();
  for (int role = 0; role < kRoles; ++role) {
    const Role one = static_cast<Role>(role);
    if (!roles.has(one) || entry.roles.has(one)) continue;
    return Status::error("this user's key is for " + roles_text(entry.roles) + ", not for " +
                         role_text(one) + ": expected the roles it was made for");
  }
  entry.roles = roles;
  return entry;
}

// The code as it is typed: no more is read than a code and some blanks have.
Result<PairingCode> ask_code(const Console& console) {
  constexpr std::size_t kLongest = 64;
  if (console.in == nullptr) return Status::error("no code: expected --code");
  console.err << "the code that the other side shows: " << std::flush;
  std::string typed;
  char c = 0;
  while (typed.size() < kLongest && console.in->get(c) && c != '\n') typed += c;
  return PairingCode::parse(typed);
}

Pairing::Book book_for(const std::string& at) {
  const KeyFolder folder = own_keys();
  return {[folder](const Trusted& entry) { return folder.may_trust(entry); },
          [folder, at](const Trusted& entry) {
            return folder.trust(entry, ", by pairing with " + at).status();
          }};
}

Result<Trusted> listen(const Options& o, const Trusted& own, const Console& console) {
  auto where = parse_host(o.listen.value_or("any"), kPairingPort, 0);
  if (!where) return Status::error("--listen " + where.message());
  const auto code = PairingCode::make();
  if (!code) return code.status();
  PairingSocket socket;
  if (const Status opened = socket.listen(*where); !opened) return opened;
  const std::string port = std::to_string(socket.port());
  const bool any = where->host == "any";
  console.out << "code: " << code->text() << '\n'
              << "listening at TCP port " << port << " of "
              << (any ? "every address of this computer" : where->host)
              << ", for one minute and one guess\n"
              << "on the other computer: handrail keys pair ROLE --with "
              << (any                                          ? computer_name()
                  : where->host.find(':') == std::string::npos ? where->host
                                                               : "[" + where->host + "]")
              << (socket.port() == kPairingPort ? "" : ":" + port) << '\n'
              << std::flush;
  return socket.serve(
      [&](const std::string& caller) {
        return Pairing::make(Pairing::Side::kListens, *code, own, book_for(caller));
      },
      kCodeLife,
      [&](const std::string& what) { console.err << what << "; still waiting" << std::endl; });
}

Result<Trusted> call(const Options& o, const Trusted& own, const Console& console) {
  const auto where = parse_host(*o.with, kPairingPort);
  if (!where) return Status::error("--with " + where.message());
  const auto code = o.code ? PairingCode::parse(*o.code) : ask_code(console);
  if (!code) return code.status();
  return PairingSocket().call(*where, [&](const std::string& at) {
    return Pairing::make(Pairing::Side::kCalls, *code, own, book_for(at));
  });
}

}  // namespace

ExitCode run_keys_pair(const Options& o, const Console& console) {
  const Roles roles = parse_roles(*o.word);
  if (roles.empty()) return complain(console, "keys pair: '" + *o.word + "': " + kRolesExpected);
  if (o.with && o.listen) {
    return complain(console, "keys pair: expected --listen on one side and --with on the other");
  }
  if (o.code && !o.with) {
    return complain(console, "keys pair: the side that waits makes the code: expected --with too");
  }
  const auto list = own_keys().trusted();
  if (!list) return refuse_keys(console, list.message());
  const auto own = own_entry(o, roles, console);
  if (!own) return refuse_keys(console, own.message());
  const auto other = o.with ? call(o, *own, console) : listen(o, *own, console);
  if (!other) return refuse_keys(console, "not paired: " + other.message());
  console.out << "trusted here: " << other->name << " as " << roles_text(other->roles) << ", key "
              << key_id(other->key) << "\ntrusted there: " << own->name << " as "
              << roles_text(own->roles) << ", key " << key_id(own->key) << '\n';
  return kExitDone;
}

}  // namespace handrail
