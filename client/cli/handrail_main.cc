// handrail: the operator's command line.
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "server/base/output.h"

int main(int argc, char** argv) {
  // What follows a typed line is its reader's, not ours: a shell's that reads a script, for one.
  std::setvbuf(stdin, nullptr, _IONBF, 0);
  const std::vector<std::string> args(argv + (argc > 0 ? 1 : 0), argv + argc);
  const handrail::Console console{std::cout, std::cerr, ::isatty(STDOUT_FILENO) == 1,
                                  ::isatty(STDERR_FILENO) == 1, &std::cin};
  return handrail::end_output("handrail", handrail::run_cli(args, console));
}
