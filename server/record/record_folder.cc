#include "server/record/record_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <regex>
#include <system_error>

namespace handrail {

std::vector<RecordingEntry> recordings_in(const std::string& folder) {
  std::vector<RecordingEntry> out;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    const std::string path = at->path().string();
    struct stat is {};
    if (at->path().extension() != kRecordingExtension) continue;
    if (::lstat(path.c_str(), &is) != 0 || !S_ISREG(is.st_mode)) continue;
    out.push_back({path, static_cast<std::uint64_t>(is.st_size),
                   is.st_mtim.tv_sec * kSecond + is.st_mtim.tv_nsec});
  }
  std::sort(out.begin(), out.end(), [](const RecordingEntry& a, const RecordingEntry& b) {
    return a.written != b.written ? a.written < b.written : a.file < b.file;
  });
  return out;
}

std::string recording_name(Nanos calendar, const std::string& side, const std::string& label) {
  const std::time_t seconds = calendar / kSecond;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[40];
  std::snprintf(text, sizeof(text), "%04d%02d%02dT%02d%02d%02d.%03dZ", utc.tm_year + 1900,
                utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                static_cast<int>(calendar % kSecond / kMillisecond));
  return std::string(text) + "-" + side + (label.empty() ? "" : "-" + label) +
         std::string(kRecordingExtension);
}

bool is_recording_of(const std::string& side, const std::string& file) {
  static const std::regex name(R"((\d{8}T\d{6}\.\d{3}Z)-(master|slave)(-[\w-]{1,40})?\.mcap)");
  const std::string last = std::filesystem::path(file).filename().string();
  std::smatch parts;
  return std::regex_match(last, parts, name) && parts[2] == side;
}

std::vector<std::string> prune(const std::string& folder, const std::string& side,
                               std::uint64_t most_bytes, Nanos oldest, const std::string& but) {
  std::vector<RecordingEntry> all = recordings_in(folder);
  std::erase_if(all, [&](const RecordingEntry& e) { return !is_recording_of(side, e.file); });
  std::uint64_t sum = 0;
  for (const RecordingEntry& entry : all) sum += entry.bytes;
  std::vector<std::string> out;
  for (const RecordingEntry& entry : all) {
    if (sum <= most_bytes && entry.written >= oldest) continue;
    if (entry.file == but || std::remove(entry.file.c_str()) != 0) continue;
    sum -= entry.bytes;
    out.push_back(entry.file);
  }
  return out;
}

}  // namespace handrail
