// Whether the arm gets to where a scene wants it.
#pragma once

#include <numbers>
#include <optional>

#include "server/model/scene.h"
#include "server/scene/field_check.h"

namespace handrail {

// How the tip stands straight in the socket of a scene that has one, X_ST's orientation: of the six
// ways its key fits the one with the most of J6's range on either side.
Quat key_in_socket(const Scene& scene) noexcept;

// The first of these that the arm, standing in whatever way, cannot reach within the scene's joint
// ranges and workspace: the points of a linear task; the bottom and the rim of a socket; for a
// screw task also where the key waits and where it is clear, and half of `turn` [rad] either way
// from key_in_socket.
std::optional<FieldProblem> out_of_reach(const Scene& scene, double turn = std::numbers::pi);

}  // namespace handrail
