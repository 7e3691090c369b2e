#include "server/keys/trust_list.h"

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/operator_name.h"

namespace handrail {
namespace {

constexpr char kExpected[] =
    "expected NAME ROLES KEY, such as `desk master p256:...`, with roles of master, slave, "
    "operator and observer, apart by commas";

// Up to three words; the last of four is not empty where there are more.
std::array<std::string_view, 4> words_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::array<std::string_view, 4> out{};
  for (auto& word : out) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t size = std::min(line.find_first_of(kBlanks), line.size());
    word = line.substr(0, size);
    line.remove_prefix(size);
  }
  return out;
}

Result<Trusted> entry_of(std::string_view line) {
  const auto words = words_of(line);
  if (words[2].empty() || !words[3].empty()) return Status::error(kExpected);
  if (const std::string problem = operator_name_problem(words[0]); !problem.empty()) {
    return Status::error(problem);
  }
  const Roles roles = parse_roles(words[1]);
  if (roles.empty()) {
    return Status::error("roles '" + std::string(words[1].substr(0, 64)) + "': " + kExpected);
  }
  const auto key = parse_key(words[2]);
  if (!key) return key.status();
  return Trusted{std::string(words[0]), roles, *key};
}

}  // namespace

Result<TrustList> TrustList::parse(std::string_view text, const std::string& place) {
  TrustList out;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const auto entry = entry_of(line);
    const Status added = entry ? out.add(*entry) : entry.status();
    if (!added) {
      return Status::error(place + ":" + std::to_string(number) + ": " + added.message());
    }
  }
  return out;
}

std::string TrustList::text() const {
  std::string out;
  for (const Trusted& entry : entries_) {
    out += entry.name + " " + roles_text(entry.roles) + " " + key_text(entry.key) + "\n";
  }
  return out;
}

const Trusted* TrustList::find(const PublicKey& key) const noexcept {
  const auto at = std::find_if(entries_.begin(), entries_.end(),
                               [&](const Trusted& entry) { return entry.key == key; });
  return at == entries_.end() ? nullptr : &*at;
}

const Trusted* TrustList::find(std::string_view name) const noexcept {
  const auto at = std::find_if(entries_.begin(), entries_.end(),
                               [&](const Trusted& entry) { return entry.name == name; });
  return at == entries_.end() ? nullptr : &*at;
}

Status TrustList::add(const Trusted& entry) {
  const Trusted* by_name = find(entry.name);
  const Trusted* by_key = find(entry.key);
  if (by_name != nullptr && by_name == by_key) {
    entries_[static_cast<std::size_t>(by_name - entries_.data())].roles = entry.roles;
    return Status::ok();
  }
  if (by_name != nullptr) {
    return Status::error("'" + entry.name + "' is here already with key " + key_id(by_name->key) +
                         ", now it comes with " + key_id(entry.key) +
                         ": if that is meant, `handrail keys remove " + entry.name + "` first");
  }
  if (by_key != nullptr) {
    return Status::error("key " + key_id(entry.key) + " is here already as '" + by_key->name +
                         "', now as '" + entry.name + "': expected one name for a key");
  }
  if (entries_.size() == kMost) {
    return Status::error("there are " + std::to_string(kMost) +
                         " keys already, the most there may be");
  }
  entries_.push_back(entry);
  return Status::ok();
}

bool TrustList::remove(std::string_view name) {
  return std::erase_if(entries_, [&](const Trusted& entry) { return entry.name == name; }) != 0;
}

}  // namespace handrail
