// handrail keys ...: who may reach the programs of this user over the network.
#pragma once

#include "client/cli/command.h"
#include "server/keys/key_folder.h"

namespace handrail {

// What a role is, where somebody asks for one that does not exist.
inline constexpr char kRolesExpected[] =
    "expected master, slave, operator, observer, or several apart by commas";

// This user's.
KeyFolder own_keys();
// This computer's name up to the first dot, of the letters that a name may have.
std::string computer_name();
// Prints the error and returns kExitRefused.
ExitCode refuse_keys(const Console& console, const std::string& text);

ExitCode run_keys_new(const Options& options, const Console& console);
ExitCode run_keys_retire(const Options& options, const Console& console);
ExitCode run_keys_show(const Options& options, const Console& console);
ExitCode run_keys_trust(const Options& options, const Console& console);
ExitCode run_keys_list(const Options& options, const Console& console);
ExitCode run_keys_remove(const Options& options, const Console& console);

// Addresses that let a browser on another computer in, once each.
ExitCode run_keys_link(const Options& options, const Console& console);
ExitCode run_keys_links(const Options& options, const Console& console);
ExitCode run_keys_unlink(const Options& options, const Console& console);

}  // namespace handrail
