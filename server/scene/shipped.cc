#include "server/scene/shipped.h"

#include <filesystem>
#include <system_error>

namespace handrail {

namespace fs = std::filesystem;

std::vector<std::string> shipped_folders(const std::string& source, const std::string& installed) {
  std::vector<std::string> folders;
  std::error_code error;
  if (fs::is_directory(source, error)) folders.push_back(source);
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return folders;
  const fs::path shared = program.parent_path().parent_path() / "share" / "handrail" / installed;
  if (fs::is_directory(shared, error)) folders.push_back(shared.string());
  return folders;
}

}  // namespace handrail
