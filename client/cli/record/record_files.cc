#include "client/cli/record/record_files.h"

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "server/base/plain_text.h"
#include "server/record/mcap/mcap.h"
#include "server/record/record_folder.h"
#include "server/record/recording_repair.h"

namespace handrail {
namespace {

constexpr double kMegabyte = 1e6;

// It has its end: nobody writes it any more, and it was not cut.
bool is_whole(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string end(kMcapMagic.size(), '\0');
  in.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  in.read(end.data(), static_cast<std::streamsize>(end.size()));
  return in && end == kMcapMagic;
}

}  // namespace

Result<std::string> recordings_text(const std::string& folder, bool json) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return Status::error(shown(folder) + ": " + (error ? error.message() : "is no folder"));
  }
  std::string out = json ? "[" : "";
  for (const RecordingEntry& entry : recordings_in(folder)) {
    const bool whole = is_whole(entry.file);
    const double mb = static_cast<double>(entry.bytes) / kMegabyte;
    if (json) {
      out += fmt::format("{}{{\"file\": \"{}\", \"mb\": {:.3f}, \"whole\": {}}}",
                         out.size() > 1 ? ",\n " : "", shown(entry.file, 4096), mb, whole);
    } else {
      out += fmt::format("{}  {:.1f} MB{}\n", shown(entry.file, 4096), mb,
                         whole ? "" : "  being written, or cut: record repair makes it whole");
    }
  }
  if (json) return out + "]\n";
  return out.empty() ? "no recordings in " + folder + "\n" : out;
}

Result<std::string> repair_text(const std::string& file, const std::string& out) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return Status::error(file + ": cannot be read: " + std::strerror(errno));
  const auto done = repair_recording(in, out);
  if (!done) return Status::error(file + ": " + done.message());
  return fmt::format("{}: {} messages, {:.3f} s{}\n", out, done->messages, done->seconds,
                     done->damage.empty() ? "; the file was whole" : "; ended by " + done->damage);
}

}  // namespace handrail
