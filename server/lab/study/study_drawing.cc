#include "server/lab/study/study_drawing.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <system_error>

namespace handrail {

Status make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Status::error(folder + ": cannot make the folder: " + error.message());
  return Status::ok();
}

std::string origin_of(const StudyHeader& header, const std::string& fitted) {
  return fmt::format(
      "Simulated operators ({}, seed {}), simulated device and arm; fitted to {} only",
      header.operators, header.seed, fitted);
}

figure::Panel measure_panel(const char* title, const char* unit, double per_si,
                            const std::vector<std::string>& modes, std::vector<ByPerson> values,
                            const double* known, const std::string& known_name) {
  figure::Axis x, y;
  x.categories = modes;
  y.label = fmt::format("{} [{}]", title, unit);
  y.low = 0.0;
  figure::Panel panel("", x, y);
  for (std::size_t i = 0; i < values.size(); ++i) {
    figure::Box box;
    box.at = static_cast<double>(i) + 1.0;
    box.style = figure::style_of(i);
    box.values = pooled(values[i]);
    for (double& value : box.values) value *= per_si;
    if (known[i] > 0.0) {
      box.published = figure::Published{known[i], fmt::format("{:.4g}", known[i]), known_name};
    }
    panel.box(std::move(box));
  }
  return panel;
}

}  // namespace handrail
