// Where browsers on other computers find this user's console, and what it shows them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/keys/certificate.h"

namespace handrail {

// In the folder of the keys the file `console`: a line "handrail-console PORT NAME...", and the
// certificate, which stays the same as long as key and names do: a browser that was told to take it
// is not asked again. Reads and writes the disk.
struct WebPlace {
  std::vector<std::string> names;  // hosts and addresses, lower case, the first for links
  std::uint16_t port = 0;
  Certificate certificate;

  // "https://desk:47004/".
  std::string url() const;

  // The one of the file where key and names are the same, or with a new certificate. Writes
  // nothing.
  static Result<WebPlace> make(const std::string& folder, const OwnKey& key,
                               std::vector<std::string> names);
  // The error says that no console has been there.
  static Result<WebPlace> load(const std::string& folder);
  Status save(const std::string& folder) const;
};

// A host as a browser writes it before a port: an address of IPv6 in brackets.
std::string web_host(const std::string& name);

}  // namespace handrail
