#include <sys/stat.h>

#include <ctime>

#include "client/doctor/gather.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

// False: there is no such file.
bool mode_of(const std::string& path, struct stat& info, std::string& text) {
  if (::stat(path.c_str(), &info) != 0) return false;
  text = formatted("%04o", static_cast<unsigned>(info.st_mode & 07777));
  return true;
}

}  // namespace

KeyFacts key_facts(const std::string& path) {
  const KeyFolder folder(path);
  KeyFacts out;
  out.folder = path;
  out.key_path = folder.key_path();
  out.trusted_path = folder.trusted_path();
  out.has_key = folder.has_key();
  struct stat info {};
  if (mode_of(out.key_path, info, out.key_mode)) {
    out.key_is_private = (info.st_mode & 077) == 0;
    out.own_age_s = static_cast<double>(std::time(nullptr) - info.st_mtime);
  }
  if (mode_of(out.trusted_path, info, out.trusted_mode)) {
    out.trusted_is_ours_to_write = (info.st_mode & 022) == 0;
  }
  if (out.has_key) {
    const auto own = folder.load();
    if (own) out.own = own->entry();
    out.own_problem = own.message();
  }
  const auto trusted = folder.trusted();
  if (trusted) out.trusted = *trusted;
  out.trusted_problem = trusted.message();
  return out;
}

}  // namespace handrail
