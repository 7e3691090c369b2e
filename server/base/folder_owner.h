// Who may put files into a folder, and so another file in the place of one.
#pragma once

#include <sys/types.h>

#include <string>

#include "server/base/status.h"

namespace handrail {

// The user whose folder it is. An error where it is none, but a link, or where anybody but its
// owner and root may write to it: names owner and mode.
Result<uid_t> folder_owner(const std::string& folder);

// "eve (uid 1001)".
std::string user_text(uid_t user);

}  // namespace handrail
