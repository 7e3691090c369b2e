#include "server/keys/key_folder.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string_view>
#include <utility>

#include "server/base/folder_owner.h"
#include "server/base/operator_name.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"

namespace handrail {
namespace {

constexpr std::size_t kMostBytes = 64 * 1024;  // 256 entries of at most 120 bytes, and comments

constexpr char kHeader[] =
    "# Whom the programs of this user let in: NAME ROLES KEY. Written by `handrail keys`.\n";

Status failure(const std::string& path, const std::string& what) {
  return Status::error(path + ": " + what);
}
Status failure(const std::string& path, const char* what, int cause) {
  return failure(path, std::string(what) + ": " + std::strerror(cause));
}

std::string mode_text(mode_t mode) {
  std::array<char, 8> out{};
  std::snprintf(out.data(), out.size(), "%04o", static_cast<unsigned>(mode & 07777));
  return out.data();
}

// A regular file of ours (or root's) that has none of the rights in `not_for_others`.
Status check(const std::string& path, mode_t not_for_others, const char* expected) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return failure(path, "cannot be read", errno);
  if (!S_ISREG(info.st_mode)) return failure(path, "is no file");
  if (info.st_uid != ::geteuid() && info.st_uid != 0) {
    return failure(path,
                   "belongs to " + user_text(info.st_uid) + ", expected " + user_text(::geteuid()));
  }
  if ((info.st_mode & not_for_others) != 0) {
    return failure(path, "has mode " + mode_text(info.st_mode) + ", so others can " + expected);
  }
  return Status::ok();
}

Status make_folder(const std::string& path) {
  std::error_code error;
  const auto above = std::filesystem::path(path).parent_path();
  if (!above.empty()) std::filesystem::create_directories(above, error);
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) {
    return failure(path, "cannot be made", errno);
  }
  const auto owner = folder_owner(path);
  if (!owner) return failure(path, owner.message());
  if (owner->user == ::geteuid() || owner->user == 0) return Status::ok();
  return failure(path,
                 "is a folder of " + owner->text + ", expected one of " + user_text(::geteuid()));
}

// Writes a file of its own, mode 0600, and leaves it at `path`: with `fresh` only where none is.
Status write_whole(const std::string& path, std::string_view text, bool fresh) {
  std::string temporary = path + ".XXXXXX";
  const int fd = ::mkstemp(temporary.data());  // mode 0600
  if (fd < 0) return failure(temporary, "cannot be made", errno);
  std::string_view left = text;
  while (!left.empty()) {
    const ssize_t written = ::write(fd, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  int cause = left.empty() && ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  if (cause == 0) {
    const bool placed = fresh ? ::link(temporary.c_str(), path.c_str()) == 0
                              : ::rename(temporary.c_str(), path.c_str()) == 0;
    if (!placed) cause = errno;
  }
  if (cause != 0 || fresh) ::unlink(temporary.c_str());
  return cause == 0 ? Status::ok() : failure(path, "cannot be written", cause);
}

// While it lives no other program of this user changes the folder. Made if need be.
class Lock {
 public:
  static Result<Lock> take(const std::string& folder) {
    if (Status made = make_folder(folder); !made) return made;
    Lock out(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    while (out.fd_ >= 0 && ::flock(out.fd_, LOCK_EX) != 0) {
      if (errno != EINTR) return failure(folder, "cannot be locked", errno);
    }
    if (out.fd_ < 0) return failure(folder, "cannot be opened", errno);
    return out;
  }
  explicit Lock(int fd) : fd_(fd) {}
  Lock(Lock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Lock& operator=(Lock&&) = delete;
  ~Lock() {
    if (fd_ >= 0) ::close(fd_);
  }

 private:
  int fd_;
};

std::string home() {
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return home;
  const ::passwd* user = ::getpwuid(::geteuid());
  return user != nullptr && user->pw_dir != nullptr ? user->pw_dir : "/";
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
  if (Status made = make_folder(path_); !made) return made;
  auto key = OwnKey::generate();
  if (!key) return key.status();
  OwnEntry out{*key, name, roles};
  if (has_key()) {
    return failure(key_path(),
                   "there is a key already; `handrail keys show` prints its public half. One that "
                   "is lost or known to others: remove this file, make another, and have it "
                   "trusted where the old one was");
  }
  const std::string header = "handrail " + name + " " + roles_text(roles) + "\n";
  const Status written = write_whole(key_path(), header + key->pem(), true);
  if (!written) return written;
  remember("made key " + key_id(key->public_key()) + " of " + name);
  return out;
}

Result<OwnEntry> KeyFolder::load() const {
  if (!has_key()) {
    return Status::error("no key at " + key_path() + ": `handrail keys new` makes one");
  }
  const Status safe = check(
      key_path(), 077,
      "read or change it, expected 0600: if nobody has, chmod 600 it; else remove it and make "
      "a new one");
  if (!safe) return safe;
  const auto text = read_file(key_path(), kMostBytes);
  if (!text) return text.status();
  auto key = OwnKey::parse(*text);
  if (!key) return failure(key_path(), key.message());
  std::istringstream header(*text);
  std::string word, name, roles;
  header >> word >> name >> roles;
  if (word != "handrail" || !is_operator_name(name) || parse_roles(roles).empty()) {
    return failure(key_path(), "the first line is '" + shown(text->substr(0, text->find('\n'))) +
                                   "': expected handrail NAME ROLES");
  }
  return OwnEntry{*key, name, parse_roles(roles)};
}

bool KeyFolder::has_key() const {
  struct stat info {};
  return ::lstat(key_path().c_str(), &info) == 0;
}

Result<TrustList> KeyFolder::trusted() const {
  struct stat info {};
  if (::lstat(trusted_path().c_str(), &info) != 0 && errno == ENOENT) return TrustList();
  const Status safe = check(trusted_path(), 022,
                            "add themselves, expected 0600: look through it, then chmod 600 it");
  if (!safe) return safe;
  const auto text = read_file(trusted_path(), kMostBytes);
  if (!text) return text.status();
  return TrustList::parse(*text, trusted_path());
}

Status KeyFolder::save(const TrustList& list, const std::string& what) const {
  if (Status made = make_folder(path_); !made) return made;
  const std::string lines = list.text();
  const std::string text = lines.starts_with('#') ? lines : kHeader + lines;
  if (text.size() > kMostBytes) {
    return failure(trusted_path(), "would have " + std::to_string(text.size()) +
                                       " bytes, expected " + std::to_string(kMostBytes) +
                                       " at most: are all of its comments needed?");
  }
  Status written = write_whole(trusted_path(), text, false);
  if (written) remember(what);
  return written;
}

Status KeyFolder::may_trust(const Trusted& entry) const {
  const auto own = load();
  if (own && own->key.public_key() == entry.key) {
    return Status::error("that is this computer's own key: it is for the other one to trust");
  }
  auto list = trusted();
  return list ? list->add(entry) : list.status();
}

Result<std::string> KeyFolder::trust(const Trusted& entry, const std::string& how) const {
  const auto act = [&](TrustList& list) -> Result<std::string> {
    if (const Status fits = may_trust(entry); !fits) return fits;
    if (const Status added = list.add(entry); !added) return added;
    return "trusted " + entry.name + " as " + roles_text(entry.roles) + ", key " +
           key_id(entry.key);
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
    list.remove(name);
    return what;
  };
  return change(act, "");
}

Result<std::string> KeyFolder::change(const std::function<Result<std::string>(TrustList&)>& act,
                                      const std::string& how) const {
  const auto locked = Lock::take(path_);
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
  for (const std::string& path : {key_path(), trusted_path()}) {
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
