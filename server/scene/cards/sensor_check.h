// Force sensors, the arm's and the handle's, as they are configured: what a field's own range does
// not say.
#pragma once

#include <optional>
#include <string>

#include "proto/config.pb.h"
#include "server/model/field_problem.h"

namespace handrail {

std::optional<FieldProblem> check_ipv4(const std::string& field, const std::string& address);
// The other end of a connection; port 0 would mean "any", which nobody can be reached at.
std::optional<FieldProblem> check_peer_port(const std::string& field, std::uint32_t port);

// Of a sensor on the network or at a card. `block`: the name of its field.
std::optional<FieldProblem> check_sensor(const pb::FtConfig& config, const std::string& block);

// The sensor on the master's device.
std::optional<FieldProblem> check_handle_sensor(const pb::MasterConfig& config);

}  // namespace handrail
