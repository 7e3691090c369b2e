#include "server/keys/once_links.h"

#include <openssl/sha.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <sstream>

#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/keys/own_files.h"
#include "server/keys/secret.h"

namespace handrail {
namespace {

constexpr std::size_t kMostLinkBytes = 64 << 10;  // 64 lines of at most 130 bytes, and comments
constexpr std::size_t kIdDigits = 6;

std::string token_hash(std::string_view token) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), hash.data());
  std::string out;
  for (const unsigned char byte : hash) {
    for (const unsigned digit : {byte / 16u, byte % 16u}) out += "0123456789abcdef"[digit];
  }
  return out;
}

bool is_lower_hex(const std::string& text, std::size_t size) {
  return text.size() == size && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// A clock that was set back makes no link good for longer.
bool is_over(const OnceLink& link, std::int64_t now) {
  return now >= link.until || now < link.made - 60;
}

void forget_old(std::vector<OnceLink>& links, std::int64_t now) {
  std::erase_if(links, [&](const OnceLink& link) {
    return now >= std::max(link.until, link.used) + OnceLinks::kSessionLife;
  });
}

}  // namespace

Result<std::vector<OnceLink>> parse_once_links(std::string_view text, const std::string& place) {
  std::vector<OnceLink> out;
  std::istringstream lines{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    OnceLink link;
    std::string role, more;
    std::istringstream words(line);
    words >> link.id >> role >> link.made >> link.until >> link.used >> link.hash;
    const auto known = parse_role(role);
    const bool may = known == Role::kOperator || known == Role::kObserver;
    const bool whole = words && !(words >> more) && may && is_lower_hex(link.id, kIdDigits) &&
                       is_lower_hex(link.hash, 64) && link.made >= 0 && link.until >= link.made &&
                       link.used >= 0;
    if (!whole || out.size() >= OnceLinks::kMost) {
      return Status::error(place + ":" + std::to_string(number) + ": '" + shown(line) +
                           "': expected ID ROLE MADE UNTIL USED HASH, " +
                           std::to_string(OnceLinks::kMost) +
                           " lines at most, as `handrail keys link` writes them: remove the file");
    }
    link.role = *known;
    out.push_back(link);
  }
  return out;
}

std::string once_links_text(const std::vector<OnceLink>& links) {
  std::ostringstream out;
  out << "# Links for browsers: ID ROLE MADE UNTIL USED HASH. Written by `handrail keys link`.\n";
  for (const OnceLink& link : links) {
    out << link.id << ' ' << role_text(link.role) << ' ' << link.made << ' ' << link.until << ' '
        << link.used << ' ' << link.hash << '\n';
  }
  return out.str();
}

Result<std::vector<OnceLink>> OnceLinks::list(std::int64_t now) const {
  struct stat info {};
  if (::lstat(path().c_str(), &info) != 0 && errno == ENOENT) return std::vector<OnceLink>();
  const Status safe = check_file(path(), 077, "read or change it, expected 0600: remove it");
  if (!safe) return safe;
  const auto text = read_file(path(), kMostLinkBytes);
  if (!text) return text.status();
  auto out = parse_once_links(*text, path());
  if (out) forget_old(*out, now);
  return out;
}

Status OnceLinks::save(const std::vector<OnceLink>& links) const {
  return write_whole(path(), once_links_text(links), false);
}

Result<OnceLinks::Made> OnceLinks::make(Role role, std::int64_t life, std::int64_t now) const {
  const auto locked = FolderLock::take(folder_);
  if (!locked) return locked.status();
  auto links = list(now);
  if (!links) return links.status();
  if (links->size() >= kMost) {
    return Status::error("there are " + std::to_string(kMost) +
                         " links: `handrail keys links` shows them, `handrail keys unlink ID` "
                         "removes one");
  }
  const auto token = new_secret(), id = new_secret();
  if (!token || !id) return (token ? id : token).status();
  const OnceLink link{id->substr(0, kIdDigits), role, now, now + life, 0, token_hash(*token)};
  links->push_back(link);
  if (Status saved = save(*links); !saved) return saved;
  return Made{link, *token};
}

Result<OnceLinks::Taken> OnceLinks::take(std::string_view token, std::int64_t now) const {
  const std::string hash = token_hash(token);
  const auto find = [&](std::vector<OnceLink>& links) {
    return std::find_if(links.begin(), links.end(),
                        [&](const OnceLink& link) { return link.hash == hash; });
  };
  // Who knows none of them makes nobody wait.
  auto links = list(now);
  if (!links) return links.status();
  if (find(*links) == links->end()) return Taken{};
  const auto locked = FolderLock::take(folder_);
  if (!locked) return locked.status();
  links = list(now);
  if (!links) return links.status();
  const auto found = find(*links);
  if (found == links->end()) return Taken{};
  if (found->used != 0) return Taken{Found::kUsed, {}};
  if (is_over(*found, now)) return Taken{Found::kExpired, {}};
  found->used = now;
  const OnceLink taken = *found;
  if (Status saved = save(*links); !saved) return saved;
  return Taken{Found::kGood, taken};
}

Result<std::string> OnceLinks::remove(const std::string& id, std::int64_t now) const {
  const auto locked = FolderLock::take(folder_);
  if (!locked) return locked.status();
  auto links = list(now);
  if (!links) return links.status();
  if (std::erase_if(*links, [&](const OnceLink& link) { return link.id == id; }) == 0) {
    return Status::error("there is no link '" + shown(id) +
                         "'; `handrail keys links` shows those that there are");
  }
  if (Status saved = save(*links); !saved) return saved;
  return "removed link " + id;
}

std::string OnceLinks::stamp() const {
  struct stat info {};
  if (::stat(path().c_str(), &info) != 0) return {};
  return std::to_string(info.st_ino) + " " + std::to_string(info.st_size) + " " +
         std::to_string(info.st_mtim.tv_sec) + "." + std::to_string(info.st_mtim.tv_nsec);
}

}  // namespace handrail
