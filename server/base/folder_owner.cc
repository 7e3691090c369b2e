#include "server/base/folder_owner.h"

#include <pwd.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

namespace handrail {

namespace {

Result<FolderOwner> owner_of(const std::string& folder, bool may_be_sticky) {
  struct stat info {};
  if (::lstat(folder.c_str(), &info) != 0) {
    return Status::error(folder + ": " + std::strerror(errno));
  }
  std::array<char, 8> mode{};
  std::snprintf(mode.data(), mode.size(), "%04o", info.st_mode & 07777u);
  const std::string user = user_text(info.st_uid);
  const std::string text = user + " with mode " + mode.data();
  if (S_ISLNK(info.st_mode)) {
    return Status::error(folder + " is a link of " + text + ", expected the folder itself");
  }
  if (!S_ISDIR(info.st_mode)) return Status::error(folder + " of " + text + " is not a folder");
  const bool others = (info.st_mode & (S_IWGRP | S_IWOTH)) != 0;
  const bool kept = may_be_sticky && (info.st_mode & S_ISVTX) != 0;
  if (!others || kept) return FolderOwner{info.st_uid, text};
  return Status::error(folder + " of " + user + " has mode " + mode.data() +
                       ": others could replace what is in it, expected 0700");
}

}  // namespace

Result<FolderOwner> folder_owner(const std::string& folder) { return owner_of(folder, false); }

Result<FolderOwner> keeper_of(const std::string& folder) { return owner_of(folder, true); }

UserEntry user_entry(uid_t user) {
  // An entry is some hundred bytes; what is longer than the most that is tried counts as none.
  for (std::size_t size = 1024; size <= 1024 * 1024; size *= 4) {
    std::vector<char> text(size);
    passwd entry{};
    passwd* found = nullptr;
    const int error = ::getpwuid_r(user, &entry, text.data(), text.size(), &found);
    if (error == ERANGE) continue;
    if (found == nullptr) break;
    return {entry.pw_name == nullptr ? "" : entry.pw_name,
            entry.pw_dir == nullptr ? "" : entry.pw_dir};
  }
  return {};
}

std::string user_text(uid_t user) {
  const std::string name = user_entry(user).name, number = "uid " + std::to_string(user);
  return name.empty() ? number : name + " (" + number + ")";
}

}  // namespace handrail
