#include "server/base/folder_owner.h"

#include <pwd.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace handrail {

Result<uid_t> folder_owner(const std::string& folder) {
  struct stat info {};
  if (::lstat(folder.c_str(), &info) != 0) {
    return Status::error(folder + ": " + std::strerror(errno));
  }
  const std::string of = " of " + user_text(info.st_uid);
  if (S_ISLNK(info.st_mode)) {
    return Status::error(folder + " is a link" + of + ", expected the folder itself");
  }
  if (!S_ISDIR(info.st_mode)) return Status::error(folder + " is not a folder");
  if ((info.st_mode & (S_IWGRP | S_IWOTH)) == 0) return info.st_uid;
  std::array<char, 8> mode{};
  std::snprintf(mode.data(), mode.size(), "%04o", info.st_mode & 07777u);
  return Status::error(folder + of + " has mode " + mode.data() +
                       ": others could replace what is in it, expected 0700");
}

std::string user_text(uid_t user) {
  const passwd* entry = ::getpwuid(user);
  const std::string number = "uid " + std::to_string(user);
  return entry == nullptr ? number : std::string(entry->pw_name) + " (" + number + ")";
}

}  // namespace handrail
