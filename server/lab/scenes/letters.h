// Letters of straight strokes, for pictures of pixels.
#pragma once

#include <string_view>

#include "server/lab/scenes/canvas.h"

namespace handrail {

// Of UTF-8 text with capitals `height` pixels high; what is not ASCII is a box.
double letters_width(std::string_view text, double height);

// `at`: the left end of the line the letters stand on.
void draw_letters(Canvas& canvas, Vec2 at, std::string_view text, double height,
                  const Colour& colour);

}  // namespace handrail
