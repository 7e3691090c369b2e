#include "client/console/gateway/site.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "server/base/read_file.h"

namespace handrail {
namespace {

constexpr std::size_t kMostFileBytes = 16u << 20;  // of the page

constexpr std::array<std::pair<std::string_view, const char*>, 10> kTypes = {{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
    {".json", "application/json"},
    {".wasm", "application/wasm"},
    {".woff2", "font/woff2"},
    {".txt", "text/plain; charset=utf-8"},
}};

bool is_plain_name(const std::string& name) {
  return !name.starts_with('.') && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

}  // namespace

Result<Site> Site::read(const std::string& folder) {
  Site out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const auto type = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const auto& known) { return name.ends_with(known.first); });
    if (!is_plain_name(name) || type == kTypes.end() || !entry.is_regular_file(error)) continue;
    const auto text = read_file(entry.path().string(), kMostFileBytes);
    if (!text) return text.status();
    out.put(name == "index.html" ? "/" : "/" + name, type->second, shared_text(*text));
  }
  if (error) return Status::error("the page's folder " + folder + ": " + error.message());
  if (!out.find("/")) {
    return Status::error("the page's folder " + folder +
                         ": there is no index.html, expected the page as `client/install "
                         "--console` builds it");
  }
  return out;
}

Site Site::without_page(const std::string& why) {
  Site out;
  out.put(
      "/", "text/html; charset=utf-8",
      shared_text("<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Handrail"
                  "</title><h1>The page is not installed</h1><p>" +
                  escaped(why) + "</p><p>The gateway runs: its WebSocket is at /ws.</p></html>\n"));
  return out;
}

std::optional<WebAnswer> Site::find(std::string_view target) const {
  const auto found = files_.find(target.substr(0, target.find('?')));
  if (found == files_.end()) return std::nullopt;
  WebAnswer out;
  out.type = found->second.type;
  out.body = found->second.body;
  return out;
}

void Site::put(const std::string& path, const std::string& type, SharedText body) {
  files_[path] = {type, std::move(body)};
}

}  // namespace handrail
