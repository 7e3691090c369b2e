// Walls painted with exact-area linear coverage, for tests and benchmarks of the proxies.
#pragma once

#include "server/lab/accuracy/wall_painter.h"

namespace handrail::test {

using namespace handrail::paint;

}  // namespace handrail::test
