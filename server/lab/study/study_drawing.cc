#include "server/lab/study/study_drawing.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "server/lab/figure/box.h"

namespace handrail {
namespace {

// Largest to smallest median [1]. Beyond it the smallest has less than a tenth of a linear axis.
constexpr double kReadable = 10.0;

}  // namespace

Status make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Status::error(folder + ": cannot make the folder: " + error.message());
  // Tried, not asked: permissions do not say all of what a disk takes.
  std::string probe = folder + "/.probe-XXXXXX";
  const int fd = ::mkstemp(probe.data());
  if (fd < 0) return Status::error(folder + ": cannot write there: " + std::strerror(errno));
  ::close(fd);
  ::unlink(probe.c_str());
  return Status::ok();
}

std::string origin_of(const StudyHeader& header, const std::string& fitted) {
  if (!header.simulated)
    return fmt::format("People ({}), at the running programs", header.operators);
  return fmt::format(
      "Simulated operators ({}, seed {}), simulated device and arm; fitted to {} only",
      header.operators, header.seed, fitted);
}

figure::Panel measure_panel(const char* title, const char* unit, double per_si,
                            const std::vector<std::string>& modes, std::vector<ByPerson> values,
                            const double* known, const char* known_word,
                            const std::string& known_name) {
  figure::Axis x, y;
  y.label = fmt::format("{} [{}]", title, unit);
  std::vector<double> medians;
  for (const ByPerson& mode : values) {
    medians.push_back(per_si * figure::box_stats(pooled(mode)).median);
  }
  const auto [least, most] = std::minmax_element(medians.begin(), medians.end());
  // What is much smaller in one mode would be a line at the axis.
  if (*least > 0.0 && *most > kReadable * *least) {
    y.scale = figure::Scale::kLog;
  } else {
    y.low = 0.0;
  }
  for (std::size_t i = 0; i < modes.size(); ++i) {
    std::string text = modes[i];
    if (std::isfinite(medians[i])) text += fmt::format("\nours\u00a0{:.3g}", medians[i]);
    if (known[i] > 0.0) text += fmt::format("\n{}\u00a0{:.4g}", known_word, known[i]);
    x.categories.push_back(std::move(text));
  }
  figure::Panel panel("", x, y);
  for (std::size_t i = 0; i < values.size(); ++i) {
    figure::Box box;
    box.at = static_cast<double>(i) + 1.0;
    box.style = figure::style_of(i);
    box.values = pooled(values[i]);
    for (double& value : box.values) value *= per_si;
    if (known[i] > 0.0) box.published = figure::Published{known[i], "", known_name};
    panel.box(std::move(box));
  }
  return panel;
}

}  // namespace handrail
