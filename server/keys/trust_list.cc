#include "server/keys/trust_list.h"

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/operator_name.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr char kExpected[] =
    "expected NAME ROLES KEY, such as `desk master p256:...`, and the next key if there is one, "
    "with "
    "roles of master, slave, operator and observer, apart by commas";

// Up to four words; the last of five is not empty where there are more.
std::array<std::string_view, 5> words_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::array<std::string_view, 5> out{};
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

}  // namespace

Result<Trusted> parse_entry(std::string_view line) {
  const auto words = words_of(line);
  if (words[2].empty() || !words[4].empty()) return Status::error(kExpected);
  if (const std::string problem = operator_name_problem(words[0]); !problem.empty()) {
    return Status::error(problem);
  }
  const Roles roles = parse_roles(words[1]);
  if (roles.empty()) {
    return Status::error("roles '" + shown(words[1]) + "': " + kExpected);
  }
  const auto key = parse_key(words[2]);
  if (!key) return key.status();
  Trusted out{std::string(words[0]), roles, *key};
  if (words[3].empty()) return out;
  const auto next = parse_key(words[3]);
  if (!next) return next.status();
  if (*next == *key) return Status::error("the next key is the key: expected another, or none");
  out.next = *next;
  return out;
}

bool same_keys(const Trusted& a, const Trusted& b) {
  return a.key == b.key || a.key == b.newest() || a.newest() == b.key || a.newest() == b.newest();
}

std::string line_text(const Trusted& entry) {
  std::string out = entry.name + " " + roles_text(entry.roles) + " " + key_text(entry.key);
  if (entry.next) out.append(" ").append(key_text(*entry.next));
  return out;
}

Result<TrustList> TrustList::parse(std::string_view text, const std::string& place) {
  TrustList out;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view line = whole.substr(0, whole.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) {
      out.lines_.push_back({std::string(whole)});
      continue;
    }
    const auto entry = parse_entry(line);
    const std::size_t before = out.entries_.size();
    const Status added = entry ? out.add(*entry) : entry.status();
    if (!added) {
      return Status::error(place + ":" + std::to_string(number) + ": " + added.message());
    }
    // An entry that comes again has changed the line above: this one goes.
    if (out.entries_.size() > before) out.lines_.back().text = whole;
  }
  return out;
}

std::string TrustList::text() const {
  std::string out;
  for (const Line& line : lines_) out.append(line.text).append("\n");
  return out;
}

std::vector<TrustList::Line>::iterator TrustList::line_of(std::size_t index) {
  return std::find_if(lines_.begin(), lines_.end(),
                      [&](const Line& line) { return line.entry && index-- == 0; });
}

const Trusted* TrustList::find(const PublicKey& key) const noexcept {
  const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Trusted& entry) {
    return entry.key == key || entry.next == key;
  });
  return at == entries_.end() ? nullptr : &*at;
}

const Trusted* TrustList::find(std::string_view name) const noexcept {
  const auto at = std::find_if(entries_.begin(), entries_.end(),
                               [&](const Trusted& entry) { return entry.name == name; });
  return at == entries_.end() ? nullptr : &*at;
}

Status TrustList::add(const Trusted& entry) {
  const Trusted* by_name = find(entry.name);
  for (const PublicKey& key : {entry.key, entry.newest()}) {
    const Trusted* by_key = find(key);
    if (by_key == nullptr || by_key == by_name) continue;
    return Status::error("key " + key_id(key) + " is here already as '" + by_key->name +
                         "', now as '" + entry.name + "': expected one name for a key");
  }
  if (by_name != nullptr && (by_name->key == entry.key || by_name->next == entry.key)) {
    replace(index_of(by_name), entry);
    return Status::ok();
  }
  // It has changed its key here already, and waits for others: the old one stays away.
  if (by_name != nullptr && entry.next == by_name->key) {
    replace(index_of(by_name), {entry.name, entry.roles, by_name->key, by_name->next});
    return Status::ok();
  }
  if (by_name != nullptr) {
    return Status::error("'" + entry.name + "' is here already with key " + key_id(by_name->key) +
                         ", now it comes with " + key_id(entry.key) +
                         ": a key that is changed comes behind the old one, as `handrail keys "
                         "show` there prints it; "
                         "if the old one is lost, `handrail keys remove " +
                         entry.name + "` first");
  }
  if (entries_.size() == kMost) {
    return Status::error("there are " + std::to_string(kMost) +
                         " keys already, the most there may be");
  }
  entries_.push_back(entry);
  lines_.push_back({line_text(entry), true});
  return Status::ok();
}

void TrustList::replace(std::size_t index, const Trusted& entry) {
  if (entries_[index] == entry) return;
  entries_[index] = entry;
  std::string& line = line_of(index)->text;
  const std::size_t comment = line.find('#');
  std::string now = line_text(entry);
  if (comment != std::string::npos) now.append(" ").append(line, comment);
  line = now;
}

std::optional<Trusted> TrustList::retire_before(const PublicKey& key) {
  const Trusted* found = find(key);
  if (found == nullptr || found->next != key) return std::nullopt;
  const Trusted before = *found;
  replace(index_of(found), {before.name, before.roles, key});
  return before;
}

bool TrustList::remove(std::string_view name) {
  const Trusted* entry = find(name);
  if (entry == nullptr) return false;
  lines_.erase(line_of(index_of(entry)));
  entries_.erase(entries_.begin() + (entry - entries_.data()));
  return true;
}

}  // namespace handrail
