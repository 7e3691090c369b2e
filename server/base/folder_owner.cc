#include "server/base/folder_owner.h"

#include <pwd.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

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

std::string user_text(uid_t user) {
  const passwd* entry = ::getpwuid(user);
  const std::string number = "uid " + std::to_string(user);
  return entry == nullptr ? number : std::string(entry->pw_name) + " (" + number + ")";
}

}  // namespace handrail
