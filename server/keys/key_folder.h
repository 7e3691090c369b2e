// Where a user's key and the list of those who are trusted live.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/keys/own_entry.h"
#include "server/keys/trust_list.h"

namespace handrail {

// $HANDRAIL_KEYS; else handrail/ in $XDG_CONFIG_HOME or in .config of the home.
std::string default_key_folder();

// A folder with `key` (private, PEM after a line with name and roles), while it is changed
// `key.next` (the same, and in its line who has confirmed it), `trusted` (lines) and `history`
// (what was changed when). Reads and writes the disk: not real-time safe.
class KeyFolder {
 public:
  explicit KeyFolder(std::string path) : path_(std::move(path)) {}

  const std::string& path() const { return path_; }
  std::string key_path() const { return path_ + "/key"; }
  std::string next_path() const { return path_ + "/key.next"; }
  std::string history_path() const { return path_ + "/history"; }
  std::string trusted_path() const { return path_ + "/trusted"; }

  // Makes a key, and the folder with mode 0700 if need be; a next one of a key that is lost goes.
  // Refuses where there is a key already.
  Result<OwnEntry> create(const std::string& name, Roles roles) const;
  // Makes the key that is to take the present one's place once everybody whom we trust and have to
  // do with has opened a session with it. Refused: there is no key, or a next one already.
  Result<OwnEntry> create_next() const;
  // The next key takes the key's place now, whoever has not confirmed it. Returns what was done.
  Result<std::string> retire() const;
  // A session serves in which we have shown `ours` and the other side `theirs`. What this
  // settles is written: a next key of theirs takes its place in the list; ours is confirmed by
  // them, and takes its place when they are the last. Nothing else changes; may be told again and
  // again.
  Status confirm(const PublicKey& ours, const PublicKey& theirs) const;
  // Those in `list` who are to confirm our next key and have not.
  static std::vector<std::string> waits_for(const OwnEntry& own, const TrustList& list);
  // Refused: not there, not ours, or a file that anybody else could read or write.
  Result<OwnEntry> load() const;
  // True when there is a file that may hold a key.
  bool has_key() const;

  // None where there is no file. Refused: one that anybody else could write.
  Result<TrustList> trusted() const;
  // In one piece or not at all. `what` goes to the history, with the time and who did it.
  Status save(const TrustList& list, const std::string& what) const;
  // Why `entry` cannot be taken into the list as it is now: our own key, a name or a key that is
  // there with another of the two, a list that cannot be read. Changes nothing.
  Status may_trust(const Trusted& entry) const;
  // Takes `entry` into the list. `how` ends the history's line. Returns what was done, without it.
  Result<std::string> trust(const Trusted& entry, const std::string& how = "") const;
  // Takes `name` off the list. Returns what was done.
  Result<std::string> distrust(const std::string& name) const;
  // A key's or a list's change shows here, without reading them: other when one has changed.
  std::string stamp() const;

 private:
  // Reads the list, lets `act` change it and say what it did, and writes it, while no other program
  // does the same.
  Result<std::string> change(const std::function<Result<std::string>(TrustList&)>& act,
                             const std::string& how) const;
  Status confirm_ours(OwnEntry own, const PublicKey& theirs) const;
  Status confirm_theirs(const PublicKey& theirs) const;
  // The next key in the key's place. `why` ends the history's line.
  Result<std::string> take_next(const OwnEntry& own, const std::string& why) const;
  // The newest lines of the history are at its end.
  void remember(const std::string& what) const;

  std::string path_;
};

}  // namespace handrail
