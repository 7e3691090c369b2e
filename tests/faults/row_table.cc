// The rows, one entry each.
#include "tests/faults/row.h"

namespace handrail::faults {
namespace {

// id, what, nearest rows in virtual time, function.
constexpr FaultRow kRows[] = {
    {"N1", "independent loss", "N1a N1b N1c", rows::n1},
    {"N2", "bursts of loss", "N2", rows::n2},
    {"N3", "constant delay", "N3", rows::n3},
    {"N4", "jitter", "N4", rows::n4},
    {"N5", "datagrams that overtake others", "N5", rows::n5},
    {"N6", "datagrams that come twice", "N6", rows::n6},
    {"N7", "damaged datagrams with right checksums", "", rows::n7},
    {"N8", "replays", "N6 X11", rows::n8},
    {"N9", "everything dark for a while", "N9", rows::n9},
    {"N10", "one way dark", "N10a N10b", rows::n10},
    {"N11", "a narrow way with a long queue", "N11", rows::n11},
    {"N12", "another address or port in motion", "", rows::n12},
    {"N13", "everything at once", "N13", rows::n13},
    {"P1", "the master stopped or killed at full speed", "P1", rows::p1},
    {"P2", "the slave killed at full speed", "", rows::p2},
    {"P3", "command lines killed", "", rows::p3},
    {"P4", "no processor to be had, no real time", "P5", rows::p4},
    {"S4", "the slave's stop switch pressed, unplugged, touched in motion", "S4", rows::s4},
    {"C1", "a calendar that leaps", "", rows::c1},
    {"C2", "monotonic clocks that differ", "C2", rows::c2},
    {"D1", "a disk that is full, broken, slow or gone while a recording is written", "", rows::d1},
    {"D2", "the master killed while a recording is written", "", rows::d2},
    {"X3", "clients without the right key", "", rows::x3},
    {"X4", "attempts to take the session over", "X4", rows::x4},
    {"X5", "a flood of junk", "", rows::x5},
    {"X10", "other versions of the wire contract", "", rows::x10},
};

}  // namespace

std::span<const FaultRow> all_rows() { return kRows; }

}  // namespace handrail::faults
