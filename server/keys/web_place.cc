#include "server/keys/web_place.h"

#include <sstream>
#include <utility>

#include "server/base/read_file.h"
#include "server/keys/own_files.h"

namespace handrail {
namespace {

constexpr std::size_t kMostPlaceBytes = 64 << 10;
constexpr char kPlaceWord[] = "handrail-console";

std::string place_path(const std::string& folder) { return folder + "/console"; }

}  // namespace

std::string web_host(const std::string& name) {
  if (name.find(':') == std::string::npos) return name;
  return std::string("[").append(name).append("]");
}

std::string WebPlace::url() const {
  std::string out = std::string("https://").append(web_host(names.front()));
  if (port != 443) out.append(":").append(std::to_string(port));
  return out + "/";
}

Result<WebPlace> WebPlace::load(const std::string& folder) {
  const std::string path = place_path(folder);
  const Status safe = check_file(path, 022, "change it, expected 0600: remove it");
  if (!safe) {
    return Status::error(
        "no console listens for other computers: start `handrail-console --listen "
        "ADDRESS:PORT` first (" +
        safe.message() + ")");
  }
  const auto text = read_file(path, kMostPlaceBytes);
  if (!text) return text.status();
  std::istringstream first(text->substr(0, text->find('\n')));
  WebPlace out;
  std::string word;
  first >> word >> out.port;
  const bool begun = first && word == kPlaceWord;
  while (first >> word) out.names.push_back(word);
  out.certificate = parse_certificate(*text);
  if (begun && !out.names.empty() && out.certificate) return out;
  return file_error(path, std::string("expected a line '") + kPlaceWord +
                              " PORT NAME...' and a certificate: remove it, and start "
                              "handrail-console anew");
}

Result<WebPlace> WebPlace::make(const std::string& folder, const OwnKey& key,
                                std::vector<std::string> names) {
  auto before = load(folder);
  if (before && before->names == names && holds_key(before->certificate, key.public_key())) {
    return before;
  }
  WebPlace out{std::move(names), 0, nullptr};
  out.certificate = certificate_of(key, out.names);
  if (!out.certificate) return Status::error("no certificate can be made for these names");
  return out;
}

Status WebPlace::save(const std::string& folder) const {
  const auto locked = FolderLock::take(folder);
  if (!locked) return locked.status();
  std::string text = std::string(kPlaceWord).append(" ").append(std::to_string(port));
  for (const std::string& name : names) text.append(" ").append(name);
  text.append("\n").append(certificate_pem(certificate));
  return write_whole(place_path(folder), text, false);
}

}  // namespace handrail
