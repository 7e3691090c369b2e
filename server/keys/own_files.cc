#include "server/keys/own_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "server/base/folder_owner.h"

namespace handrail {

Status file_error(const std::string& path, const std::string& what) {
  return Status::error(path + ": " + what);
}
Status file_error(const std::string& path, const char* what, int cause) {
  return file_error(path, std::string(what) + ": " + std::strerror(cause));
}

std::string mode_text(mode_t mode) {
  std::array<char, 8> out{};
  std::snprintf(out.data(), out.size(), "%04o", static_cast<unsigned>(mode & 07777));
  return out.data();
}

Status check_file(const std::string& path, mode_t not_for_others, const char* expected) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return file_error(path, "cannot be read", errno);
  if (!S_ISREG(info.st_mode)) return file_error(path, "is no file");
  if (info.st_uid != ::geteuid() && info.st_uid != 0) {
    return file_error(
        path, "belongs to " + user_text(info.st_uid) + ", expected " + user_text(::geteuid()));
  }
  if ((info.st_mode & not_for_others) != 0) {
    return file_error(path, "has mode " + mode_text(info.st_mode) + ", so others can " + expected);
  }
  return Status::ok();
}

Status make_own_folder(const std::string& path) {
  std::error_code error;
  const auto above = std::filesystem::path(path).parent_path();
  if (!above.empty()) std::filesystem::create_directories(above, error);
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) {
    return file_error(path, "cannot be made", errno);
  }
  const auto owner = folder_owner(path);
  if (!owner) return file_error(path, owner.message());
  if (owner->user == ::geteuid() || owner->user == 0) return Status::ok();
  return file_error(
      path, "is a folder of " + owner->text + ", expected one of " + user_text(::geteuid()));
}

Status write_whole(const std::string& path, std::string_view text, bool fresh) {
  std::string temporary = path + ".XXXXXX";
  const int fd = ::mkstemp(temporary.data());  // mode 0600
  if (fd < 0) return file_error(temporary, "cannot be made", errno);
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
  return cause == 0 ? Status::ok() : file_error(path, "cannot be written", cause);
}

Result<FolderLock> FolderLock::take(const std::string& folder) {
  if (Status made = make_own_folder(folder); !made) return made;
  FolderLock out(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  while (out.fd_ >= 0 && ::flock(out.fd_, LOCK_EX) != 0) {
    if (errno != EINTR) return file_error(folder, "cannot be locked", errno);
  }
  if (out.fd_ < 0) return file_error(folder, "cannot be opened", errno);
  return out;
}

FolderLock::~FolderLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace handrail
