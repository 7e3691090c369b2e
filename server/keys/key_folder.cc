#include "server/keys/key_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iomanip>

#include "server/base/folder_owner.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/keys/own_files.h"

namespace handrail {
namespace {

constexpr std::size_t kMostBytes = 64 * 1024;  // 256 entries of at most 120 bytes, and comments

constexpr char kHeader[] =
    "# Whom the programs of this user let in: NAME ROLES KEY. Written by `handrail keys`.\n";

Result<OwnEntry> read_key(const std::string& path) {
  const Status safe = check_file(
      path, 077,
      "read or change it, expected 0600: if nobody has, chmod 600 it; else remove it and make "
      "a new one");
  if (!safe) return safe;
  const auto text = read_file(path, kMostBytes);
  if (!text) return text.status();
  auto entry = parse_own(*text);
  return entry ? entry : file_error(path, entry.message());
}

std::string home() {
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return home;
  const std::string known = user_entry(::geteuid()).home;
  return known.empty() ? "/" : known;
}

}  // namespace

std::string default_key_folder() {
  const char* told = std::getenv("HANDRAIL_KEYS");
  if (told != nullptr && *told != '\0') return told;
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && *config == '/') return std::string(config) + "/handrail";
  return home() + "/.config/handrail";
}

Result<OwnEntry> KeyFolder::create(const std::string& name, Roles roles) const {
  const auto locked = FolderLock::take(path_);
  if (!locked) return locked.status();
  auto key = OwnKey::generate();
  if (!key) return key.status();
  OwnEntry out{*key, name, roles};
  if (has_key()) {
    return file_error(
        key_path(),
        "there is a key already; `handrail keys show` prints its public half. One that "
        "is lost or known to others: remove this file, make another, and have it "
        "trusted where the old one was");
  }
  const Status written = write_whole(key_path(), own_text(out, out.key), true);
  if (!written) return written;
  remember("made key " + key_id(key->public_key()) + " of " + name);
  if (::unlink(next_path().c_str()) == 0) remember("removed the next key of one that is lost");
  return out;
}

Result<OwnEntry> KeyFolder::create_next() const {
  const auto locked = FolderLock::take(path_);
  if (!locked) return locked.status();
  auto own = load();
  if (!own) return own;
  if (own->next) {
    return file_error(
        next_path(),
        "there is a next key already, " + key_id(own->next->public_key()) +
            ", which waits to be confirmed; `handrail keys show` prints the line for it, "
            "`handrail keys retire` ends the old one now");
  }
  auto key = OwnKey::generate();
  if (!key) return key.status();
  own->next = *key;
  // Not `fresh`: one that a broken change has left may lie there.
  Status written = write_whole(next_path(), own_text(*own, *own->next), false);
  if (!written) return written;
  remember("made next key " + key_id(key->public_key()) + " of " + own->name + ", for " +
           key_id(own->key.public_key()));
  return own;
}

Result<std::string> KeyFolder::retire() const {
  const auto locked = FolderLock::take(path_);
  if (!locked) return locked.status();
  const auto own = load();
  if (!own) return own.status();
  if (!own->next) {
    return Status::error("there is no next key: `handrail keys new` makes one");
  }
  return take_next(*own, "by hand");
}

Result<std::string> KeyFolder::take_next(const OwnEntry& own, const std::string& why) const {
  const OwnEntry now{*own.next, own.name, own.roles};
  // Until the second step the two files hold the same key, which load() takes for one.
  const Status written = write_whole(key_path(), own_text(now, now.key), false);
  if (!written) return written;
  ::unlink(next_path().c_str());
  std::string what = "retired key " + key_id(own.key.public_key()) + " of " + own.name + " for " +
                     key_id(now.key.public_key());
  remember(what + ", " + why);
  return what;
}

std::vector<std::string> KeyFolder::waits_for(const OwnEntry& own, const TrustList& list) {
  std::vector<std::string> out;
  for (const Trusted& entry : list.entries()) {
    const auto& done = own.confirmed;
    if (meet(own.roles, entry.roles) &&
        std::find(done.begin(), done.end(), entry.name) == done.end()) {
      out.push_back(entry.name);
    }
  }
  return out;
}

Status KeyFolder::confirm(const PublicKey& ours, const PublicKey& theirs) const {
  const auto locked = FolderLock::take(path_);
  if (!locked) return locked.status();
  if (Status done = confirm_theirs(theirs); !done) return done;
  const auto own = load();
  if (!own) return own.status();
  if (!own->next || own->next->public_key() != ours) return Status::ok();
  return confirm_ours(*own, theirs);
}

Status KeyFolder::confirm_theirs(const PublicKey& theirs) const {
  auto list = trusted();
  if (!list) return list.status();
  const auto before = list->retire_before(theirs);
  if (!before) return Status::ok();
  return save(*list, before->name + " has changed its key: " + key_id(before->key) +
                         " is trusted no longer, " + key_id(theirs) + " is");
}

Status KeyFolder::confirm_ours(OwnEntry own, const PublicKey& theirs) const {
  const auto list = trusted();
  if (!list) return list.status();
  const Trusted* who = list->find(theirs);
  const auto waits = waits_for(own, *list);
  if (who == nullptr || std::find(waits.begin(), waits.end(), who->name) == waits.end()) {
    return Status::ok();
  }
  own.confirmed.push_back(who->name);
  if (waits.size() == 1) return take_next(own, "confirmed by " + who->name).status();
  Status written = write_whole(next_path(), own_text(own, *own.next), false);
  if (written) {
    remember("next key " + key_id(own.next->public_key()) + " is confirmed by " + who->name);
  }
  return written;
}

Result<OwnEntry> KeyFolder::load() const {
  if (!has_key()) {
    return Status::error("no key at " + key_path() + ": `handrail keys new` makes one");
  }
  auto own = read_key(key_path());
  struct stat info {};
  if (!own || ::lstat(next_path().c_str(), &info) != 0) return own;
  auto next = read_key(next_path());
  if (!next) return next;
  if (next->key.public_key() == own->key.public_key()) return own;
  own->next = next->key;
  own->confirmed = next->confirmed;
  return own;
}

bool KeyFolder::has_key() const {
  struct stat info {};
  return ::lstat(key_path().c_str(), &info) == 0;
}

Result<TrustList> KeyFolder::trusted() const {
  struct stat info {};
  if (::lstat(trusted_path().c_str(), &info) != 0 && errno == ENOENT) return TrustList();
  const Status safe = check_file(
      trusted_path(), 022, "add themselves, expected 0600: look through it, then chmod 600 it");
  if (!safe) return safe;
  const auto text = read_file(trusted_path(), kMostBytes);
  if (!text) return text.status();
  return TrustList::parse(*text, trusted_path());
}

Status KeyFolder::save(const TrustList& list, const std::string& what) const {
  if (Status made = make_own_folder(path_); !made) return made;
  const std::string lines = list.text();
  const std::string text = lines.starts_with('#') ? lines : kHeader + lines;
  if (text.size() > kMostBytes) {
    return file_error(trusted_path(), "would have " + std::to_string(text.size()) +
                                          " bytes, expected " + std::to_string(kMostBytes) +
                                          " at most: are all of its comments needed?");
  }
  Status written = write_whole(trusted_path(), text, false);
  if (written) remember(what);
  return written;
}

Status KeyFolder::may_trust(const Trusted& entry) const {
  const auto own = load();
  if (own && own->is_ours(entry)) {
    return Status::error("that is this computer's own key: it is for the other one to trust");
  }
  auto list = trusted();
  return list ? list->add(entry) : list.status();
}

Result<std::string> KeyFolder::trust(const Trusted& entry, const std::string& how) const {
  const auto act = [&](TrustList& list) -> Result<std::string> {
    if (const Status fits = may_trust(entry); !fits) return fits;
    if (const Status added = list.add(entry); !added) return added;
    const Trusted& now = *list.find(entry.name);  // perhaps without the old one of two keys
    return "trusted " + now.name + " as " + roles_text(now.roles) + ", key " + key_id(now.key) +
           (now.next ? ", the next " + key_id(*now.next) : "");
  };
  return change(act, how);
}

Result<std::string> KeyFolder::distrust(const std::string& name) const {
  const auto act = [&](TrustList& list) -> Result<std::string> {
    const Trusted* entry = list.find(name);
    if (entry == nullptr) {
      return Status::error("there is no '" + shown(name) + "' in " + trusted_path() +
                           "; `handrail keys list` shows who is");
    }
    std::string what = "removed " + entry->name + ", key " + key_id(entry->key);
    if (entry->next) what += ", the next " + key_id(*entry->next);
    list.remove(name);
    return what;
  };
  return change(act, "");
}

Result<std::string> KeyFolder::change(const std::function<Result<std::string>(TrustList&)>& act,
                                      const std::string& how) const {
  const auto locked = FolderLock::take(path_);
  if (!locked) return locked.status();
  auto list = trusted();
  if (!list) return list.status();
  auto what = act(*list);
  if (!what) return what;
  if (const Status saved = save(*list, *what + how); !saved) return saved;
  return what;
}

void KeyFolder::remember(const std::string& what) const {
  std::ofstream history(history_path(), std::ios::app);
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  history << std::put_time(&parts, "%Y-%m-%dT%H:%M:%SZ ") << user_text(::geteuid()) << ": " << what
          << '\n';
}

std::string KeyFolder::stamp() const {
  std::string out;
  for (const std::string& path : {key_path(), next_path(), trusted_path()}) {
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0) {
      out += std::to_string(info.st_ino) + " " + std::to_string(info.st_size) + " " +
             std::to_string(info.st_mtim.tv_sec) + "." + std::to_string(info.st_mtim.tv_nsec) +
             " " + mode_text(info.st_mode);
    }
    out += ";";
  }
  return out;
}

}  // namespace handrail
