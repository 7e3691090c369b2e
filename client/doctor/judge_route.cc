#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

constexpr int kUdpHeader = 8, kIpv4Header = 20, kIpv6Header = 40;  // [bytes]
// What a path of IPv6 carries whole [bytes] (RFC 8200, section 5): nothing of ours is longer.
constexpr int kEveryPath = 1280;

const char* tunnel_text(Tunnel tunnel) {
  return tunnel == Tunnel::kWireGuard ? "WireGuard" : "Tailscale";
}

}  // namespace

void judge_route(const DoctorFacts& facts, Findings& out) {
  if (!facts.route) return;
  const RouteFacts& route = *facts.route;
  if (!route.problem.empty()) {
    out.push_back({"route.way", Level::kProblem, "no way to " + route.to + ": " + route.problem,
                   "ip route get " + route.to.substr(0, route.to.rfind(':')) +
                       "   says what this computer would do"});
    return;
  }
  const std::string through =
      "the way to " + route.to + " goes through " +
      (route.interface.empty() ? "an interface that has no name here" : route.interface);
  out.push_back({"route.way", Level::kOk,
                 through + (route.tunnel == Tunnel::kNone
                                ? std::string()
                                : std::string(", which is ") + tunnel_text(route.tunnel)),
                 ""});
  if (route.mtu <= 0) return;
  const int around = kUdpHeader + (route.v6 ? kIpv6Header : kIpv4Header);
  const int datagram = static_cast<int>(facts.largest_datagram) + around;
  const int handshake = static_cast<int>(facts.largest_handshake) + around;
  const std::string fact = formatted(
      "%d bytes go through it whole, as the kernel knows the path; with everything around it a "
      "datagram of the link has %d at most, one of its handshake %d; any path with %d will do",
      route.mtu, datagram, handshake, kEveryPath);
  if (route.mtu >= handshake) {
    out.push_back({"route.mtu", Level::kOk, fact, ""});
    return;
  }
  out.push_back(
      {"route.mtu", Level::kProblem,
       fact + (route.mtu < datagram ? "; every datagram is cut in pieces, or lost"
                                    : "; handshakes are cut in pieces, or lost"),
       "ip link set " + (route.interface.empty() ? "INTERFACE" : route.interface) +
           formatted(" mtu %d   as root, on both computers, or what is smaller on the way",
                     kEveryPath)});
}

}  // namespace handrail
