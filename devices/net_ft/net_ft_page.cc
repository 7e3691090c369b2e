#include "devices/net_ft/net_ft_page.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <span>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

struct Unit {
  const char* name;
  double size;  // [N] or [N m]
};

// A pound-force is 4.4482216152605 N, an inch 0.0254 m, a kilogram-force 9.80665 N, all exactly.
constexpr double kPound = 4.4482216152605, kInch = 0.0254, kKilogram = 9.80665;
constexpr Unit kForceUnits[] = {
    {"N", 1.0}, {"kN", 1e3}, {"lbf", kPound}, {"klbf", 1e3 * kPound}, {"kg", kKilogram}};
constexpr Unit kTorqueUnits[] = {{"N-m", 1.0},
                                 {"Nm", 1.0},
                                 {"N-mm", 1e-3},
                                 {"Nmm", 1e-3},
                                 {"kN-m", 1e3},
                                 {"kNm", 1e3},
                                 {"lbf-in", kPound* kInch},
                                 {"lbf-ft", kPound * 12.0 * kInch},
                                 {"kg-cm", kKilogram * 1e-2}};

// What stands between <name> and </name>; none: there is no such field.
std::optional<std::string> field(const std::string& xml, const std::string& name) {
  const std::string opens = "<" + name + ">";
  const std::size_t begins = xml.find(opens);
  if (begins == std::string::npos) return std::nullopt;
  const std::size_t at = begins + opens.size();
  const std::size_t ends = xml.find("</" + name + ">", at);
  if (ends == std::string::npos) return std::nullopt;
  const std::size_t first = xml.find_first_not_of(" \t\r\n", at);
  if (first >= ends) return std::string();
  const std::size_t last = xml.find_last_not_of(" \t\r\n", ends - 1);
  return xml.substr(first, last - first + 1);
}

Status wrong(const std::string& name, const std::string& text, const std::string& expected) {
  return Status::error("netftapi2.xml: " + name + " is '" + shown(text) + "', expected " +
                       expected);
}

Result<double> positive(const std::string& xml, const std::string& name) {
  const auto text = field(xml, name);
  if (!text)
    return Status::error("netftapi2.xml: there is no " + name + ": is this a Net F/T sensor?");
  double value = 0.0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  const bool whole = error == std::errc() && end == text->data() + text->size();
  if (!whole || !std::isfinite(value) || !(value > 0.0)) {
    return wrong(name, *text, "a number above 0");
  }
  return value;
}

Result<double> unit(const std::string& xml, const std::string& name, std::span<const Unit> known) {
  const std::string text = field(xml, name).value_or("");
  std::vector<std::string> names;
  for (const Unit& one : known) {
    if (text == one.name) return one.size;
    names.emplace_back(one.name);
  }
  return wrong(name, text, joined(names, ", "));
}

// 0: there is no such field, or no number in it.
template <typename Number>
Number number_or_none(const std::string& xml, const std::string& name, int base) {
  const std::string text = field(xml, name).value_or("");
  const std::size_t skip = base == 16 && text.starts_with("0x") ? 2 : 0;
  Number value = 0;
  const auto [end, error] =
      std::from_chars(text.data() + skip, text.data() + text.size(), value, base);
  return error == std::errc() && end == text.data() + text.size() ? value : Number{0};
}

}  // namespace

Result<NetFtPage> parse_net_ft_page(const std::string& xml) {
  const auto per_force = positive(xml, "cfgcpf");
  if (!per_force) return per_force.status();
  const auto per_torque = positive(xml, "cfgcpt");
  if (!per_torque) return per_torque.status();
  const auto force = unit(xml, "scfgfu", kForceUnits);
  if (!force) return force.status();
  const auto torque = unit(xml, "scfgtu", kTorqueUnits);
  if (!torque) return torque.status();
  NetFtPage out;
  out.counts_per_n = *per_force / *force;
  out.counts_per_n_m = *per_torque / *torque;
  out.units = *field(xml, "scfgfu") + " and " + *field(xml, "scfgtu");
  out.streams = field(xml, "comrdte").value_or("Enabled") != "Disabled";
  out.rate_hz = number_or_none<int>(xml, "comrdtrate", 10);
  out.status = number_or_none<unsigned>(xml, "runstat", 16);
  return out;
}

}  // namespace handrail
