#include "server/lab/accuracy/resolve_io.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "server/base/output.h"
#include "server/base/units.h"
#include "server/lab/accuracy/choices.h"
#include "server/lab/accuracy/wall_choice.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

struct Unit {
  const char* name;
  double factor;
};

// Reads a positive number and one of two units.
Result<double> amount(const std::string& option, const std::string& text, const Unit (&units)[2]) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  for (const Unit& unit : units) {
    if (error != std::errc() || std::string(rest, end) != unit.name) continue;
    if (std::isfinite(value) && value > 0.0) return value * unit.factor;
  }
  return Status::error(fmt::format("--{} {}: expected a number above 0 with its unit, {} or {}",
                                   option, text, units[0].name, units[1].name));
}

// Pixels the test walls can be painted with [m].
constexpr double kFinest = 0.02e-3, kCoarsest = 0.4e-3;

// On test walls of the scene's own pixel. Walls for finer or coarser ones are smaller or larger
// copies: their errors are in the same proportion.
AccuracyRows painted_rows(double pixel, const std::atomic<bool>& cancelled) {
  const double measured = std::clamp(pixel, kFinest, kCoarsest);
  std::vector<WallSetting> settings = {{WallMethod::kSubpixel, measured, 0.0}};
  for (const double radius : {1.5, 2.5, 3.0, 4.0}) {
    settings.push_back({WallMethod::kPublished, measured, radius});
  }
  AccuracyRows rows = wall_rows(settings, cancelled);
  for (std::size_t i = 0; i < rows.size() && measured != pixel; ++i) {
    for (AccuracyRow::Error* error : {&rows[i].error, &rows[i].whole}) {
      error->rms *= pixel / measured;
      error->worst *= pixel / measured;
    }
    rows[i].setting = describe({settings[i].method, pixel, settings[i].radius});
    if (!rows[i].note.empty()) rows[i].note += "; ";
    rows[i].note += fmt::format("measured with pixels of {:g} mm", measured / kMm);
  }
  return rows;
}

AccuracyRows rows_for(const Scene& scene, const std::atomic<bool>& cancelled) {
  if (!scene.walls) return tool_rows(cancelled);
  if (!scene.walls->map) return wall_rows({{WallMethod::kExact, 0.0, 0.0}}, cancelled);
  return painted_rows(scene.walls->map->pixel, cancelled);
}

// The number between `before` and what follows it in a row's setting.
double number_after(const std::string& setting, const std::string& before) {
  const std::size_t at = setting.find(before);
  return at == std::string::npos ? 0.0 : std::stod(setting.substr(at + before.size()));
}

void apply(const AccuracyRow& row, pb::Scene& scene) {
  if (row.choice == "tool_step") {
    const bool exact = row.method == "exact";
    scene.mutable_guidance()->set_method(exact ? pb::Guidance::EXACT : pb::Guidance::PUBLISHED);
    if (!exact) scene.mutable_guidance()->set_delta_mm(number_after(row.setting, "delta "));
    return;
  }
  pb::Walls& walls = *scene.mutable_walls();
  walls.clear_search_radius_px();
  if (row.method == name_of(WallMethod::kPublished)) {
    walls.set_method(pb::Walls::PUBLISHED);
    walls.set_search_radius_px(number_after(row.setting, "radius "));
  } else {
    walls.set_method(row.method == name_of(WallMethod::kExact) ? pb::Walls::EXACT
                                                               : pb::Walls::SUBPIXEL);
  }
}

std::string wish_text(const AccuracyWish& wish) {
  return wish.most_error > 0.0 ? fmt::format("an error of at most {:g} um", wish.most_error)
                               : fmt::format("at most {:g} ns an update", wish.most_cost);
}

std::string figures_of(const AccuracyRow& row) {
  const auto off = [](const AccuracyRow::Error& error) {
    return fmt::format("{:.3g} um RMS, {:.3g} um at worst", error.rms, error.worst);
  };
  const bool two = !row.whole.unit.empty();
  return fmt::format("{}, {}: the proxy off by {}{}, {:.0f} ns an update", row.method, row.setting,
                     off(row.whole_error()),
                     two ? " from the exact one, " + off(row.error) + " from the surface" : "",
                     row.cost.median);
}

// The row that comes nearest to the wish.
const AccuracyRow& nearest(const AccuracyRows& rows, const AccuracyWish& wish) {
  return *std::min_element(
      rows.begin(), rows.end(), [&](const AccuracyRow& a, const AccuracyRow& b) {
        return wish.most_error > 0.0 ? a.whole_error().worst < b.whole_error().worst
                                     : a.cost.median < b.cost.median;
      });
}

// Whether a copy of `from` may be written there: a new file with a scene's name.
Status check_place(const std::string& from, const std::string& out) {
  namespace fs = std::filesystem;
  const fs::path path(out);
  if (path.extension() != kSceneExtension || !is_scene_name(path.stem().string())) {
    return Status::error(out + ": expected a file NAME.scene, letters, digits, - and _");
  }
  std::error_code error;
  if (fs::equivalent(path, from, error)) {
    return Status::error(out + ": is the scene itself, expected another file");
  }
  // A link that leads nowhere, too.
  if (fs::exists(fs::symlink_status(path, error))) {
    return Status::error(out +
                         ": is there already, expected a new file; remove it or name another");
  }
  return Status::ok();
}

// Moves the image's path to where the copy stands, and writes.
Status write_copy(pb::Scene scene, const std::string& from, const std::string& why,
                  const std::string& out) {
  namespace fs = std::filesystem;
  const fs::path path(out);
  scene.set_name(path.stem().string());
  if (scene.has_walls() && scene.walls().has_image()) {
    const fs::path image =
        fs::absolute(fs::path(from)).parent_path() / scene.walls().image().file();
    const fs::path folder = fs::absolute(path).parent_path();
    scene.mutable_walls()->mutable_image()->set_file(
        image.lexically_normal().lexically_relative(folder.lexically_normal()).string());
  }
  std::string text;
  google::protobuf::TextFormat::PrintToString(scene, &text);
  text = "# A copy of " + from + ".\n# " + why + "\n" + text;
  // What is written loads, or nothing is.
  if (const auto loads = parse_scene(out, text); !loads) return loads.status();
  return write_file(out, text);
}

}  // namespace

Result<AccuracyWish> accuracy_wish(const std::string& accuracy, const std::string& budget) {
  if (accuracy.empty() == budget.empty()) {
    return Status::error("expected either --accuracy, such as 0.01mm, or --budget, such as 500ns");
  }
  static constexpr Unit kLengths[2] = {{"mm", 1e3}, {"um", 1.0}};
  static constexpr Unit kTimes[2] = {{"ns", 1.0}, {"us", 1e3}};
  AccuracyWish out;
  const auto value =
      accuracy.empty() ? amount("budget", budget, kTimes) : amount("accuracy", accuracy, kLengths);
  if (!value) return value.status();
  (accuracy.empty() ? out.most_cost : out.most_error) = *value;
  return out;
}

int choose(const AccuracyRows& rows, const AccuracyWish& wish) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
    const AccuracyRow& row = rows[static_cast<std::size_t>(i)];
    const bool meets = wish.most_error > 0.0 ? row.whole_error().worst <= wish.most_error
                                             : row.cost.median <= wish.most_cost;
    if (!meets) continue;
    if (best < 0) {
      best = i;
      continue;
    }
    const AccuracyRow& held = rows[static_cast<std::size_t>(best)];
    const bool cheaper = row.cost.median < held.cost.median;
    const bool better = wish.most_error > 0.0
                            ? cheaper
                            : row.whole_error().rms < held.whole_error().rms ||
                                  (row.whole_error().rms == held.whole_error().rms && cheaper);
    if (better) best = i;
  }
  return best;
}

Result<Resolved> resolve_scene(const std::string& scene_file, const AccuracyWish& wish,
                               const std::string& out, const std::atomic<bool>& cancelled) {
  pb::Scene raw;
  const Result<Scene> scene = load_scene_file(scene_file, &raw);
  if (!scene) return scene.status();
  // Before measuring, which takes a while.
  if (Status s = check_place(scene_file, out); !s) return s;
  Resolved resolved;
  resolved.rows = rows_for(*scene, cancelled);
  if (cancelled) return Status::error("cancelled");
  resolved.chosen = choose(resolved.rows, wish);
  if (resolved.chosen < 0) {
    return Status::error(scene_file + ": no setting gives " + wish_text(wish) + "; nearest is " +
                         figures_of(nearest(resolved.rows, wish)));
  }
  const AccuracyRow& row = resolved.rows[static_cast<std::size_t>(resolved.chosen)];
  resolved.why =
      (wish.most_error > 0.0 ? "The cheapest setting with " : "The most accurate with ") +
      wish_text(wish) + ", as measured here: " + figures_of(row) + ".";
  apply(row, raw);
  if (Status s = write_copy(raw, scene_file, resolved.why, out); !s) return s;
  return resolved;
}

}  // namespace handrail
