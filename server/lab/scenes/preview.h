// A scene's walls as a picture: what the hand would feel and where the proxy goes.
#pragma once

#include "server/base/status.h"
#include "server/lab/scenes/canvas.h"
#include "server/model/scene.h"

namespace handrail {

inline constexpr int kPreviewSide = 1000;  // longer side of the walls' picture [pixels]

// Colours of what is drawn. Regions have those of their palette; drawn shapes without one are
// white, walls grey.
inline constexpr Colour kForceColour = {31, 90, 166};   // arrows, crosses
inline constexpr Colour kHandColour = {84, 84, 84};     // thin line
inline constexpr Colour kProxyColour = {212, 87, 15};   // thick line
inline constexpr Colour kStartColour = {61, 167, 143};  // dot

// Draws the first stage's walls; the force on a hand at rest at the points of a grid, the device's
// peak as long as the grid is wide and others with the square root of their size, and a cross where
// the proxy is too far for the force to mean anything; and the ways of a hand that wanders for 12 s
// and of its proxy, but for what that goes within a tick around a corner. Below the walls a strip
// with a bar for the scale and the meaning of all colours and marks. The error says that the scene
// has no walls.
Result<Canvas> preview_scene(const Scene& scene);

}  // namespace handrail
