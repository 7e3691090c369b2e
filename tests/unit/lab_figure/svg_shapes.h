// Looks into SVG text: elements and their attributes.
#pragma once

#include <string>
#include <vector>

namespace handrail::figure {

// All start tags of that name, in order.
inline std::vector<std::string> elements(const std::string& svg, const std::string& name) {
  std::vector<std::string> out;
  for (std::size_t at = svg.find("<" + name + " "); at != std::string::npos;
       at = svg.find("<" + name + " ", at + 1)) {
    out.push_back(svg.substr(at, svg.find('>', at) + 1 - at));
  }
  return out;
}

// Empty when the element has no such attribute.
inline std::string attribute(const std::string& element, const std::string& name) {
  const std::string head = " " + name + "=\"";
  const std::size_t at = element.find(head);
  if (at == std::string::npos) return "";
  const std::size_t from = at + head.size();
  return element.substr(from, element.find('"', from) - from);
}

inline double value(const std::string& element, const std::string& name) {
  return std::stod(attribute(element, name));
}

// Elements among `all` whose attribute is `wanted`.
inline std::vector<std::string> having(const std::vector<std::string>& all, const std::string& name,
                                       const std::string& wanted) {
  std::vector<std::string> out;
  for (const std::string& element : all) {
    if (attribute(element, name) == wanted) out.push_back(element);
  }
  return out;
}

// True when every start tag is ended, in order, and one element holds all others.
inline bool well_formed(const std::string& xml) {
  std::vector<std::string> open;
  int roots = 0;
  std::size_t at = xml.find("?>");
  at = at == std::string::npos ? 0 : at + 2;
  for (at = xml.find('<', at); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos) return false;
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else {
      roots += open.empty() ? 1 : 0;
      if (tag.back() != '/') open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty() && roots == 1;
}

}  // namespace handrail::figure
