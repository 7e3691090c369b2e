// Ctrl-C as a question, for commands that go on until then.
#pragma once

namespace handrail {

// From here on ending_signals() no longer end the program, nor does writing to a reader that has
// gone: the stream fails instead.
void catch_interrupts();
// One of them has come since.
bool interrupted();
// What was printed and a stopped terminal has not taken is not waited for any more.
void drop_output();

}  // namespace handrail
