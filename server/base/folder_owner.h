// Who may put files into a folder, and so another file in the place of one.
#pragma once

#include <sys/types.h>

#include <string>

#include "server/base/status.h"

namespace handrail {

struct FolderOwner {
  uid_t user = 0;
  std::string text;  // "eve (uid 1001) with mode 0755"
};

// The user whose folder it is. An error where it is none, but a link, or where anybody but its
// owner and root may write to it: names owner and mode.
Result<FolderOwner> folder_owner(const std::string& folder);

// Who but root may replace what is in `folder` and belongs to somebody else. As above, but in a
// sticky folder, as /tmp is, others may have things of their own.
Result<FolderOwner> keeper_of(const std::string& folder);

// What the system knows of a user; empty: nothing. From any thread. Reads the disk, or asks
// further.
struct UserEntry {
  std::string name, home;
};
UserEntry user_entry(uid_t user);

// "eve (uid 1001)".
std::string user_text(uid_t user);

}  // namespace handrail
