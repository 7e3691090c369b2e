#include "tests/desk/results.h"

#include <spdlog/fmt/fmt.h>

namespace handrail::desk {
namespace {

// A device that is away now and then, or drives nothing, would look quick.
constexpr double kLeastValid = 0.99, kLeastEngaged = 0.9;

const char* yes_or_no(bool yes) { return yes ? "true" : "false"; }

bool grows_little(const LoopFigures& f) {
  return f.valid >= kLeastValid && f.engaged >= kLeastEngaged && f.late_grows <= kMostGrowth &&
         f.work_grows <= kMostGrowth;
}

std::string spread_json(const LoopSpread& s) {
  return fmt::format("{{\"median\":{:.3f},\"p999\":{:.3f},\"worst\":{:.3f}}}", s.median, s.most,
                     s.worst);
}

}  // namespace

std::string soak_text(const SoakPlan& plan, const SoakFigures& f) {
  return fmt::format(
      "spacenavd with a Magellan at a pseudo-terminal, {:g} frames/s for {:.0f} s\n"
      "  {} frames pushed, {} times there was no room for one\n"
      "  {} told by spacenavd, which kept {} to itself; {} of them astray\n"
      "  {} heard by the driver, {} lost; {} of its readings not valid\n"
      "  in the worst second 99.9 % of its readings were no later than {:.2f} ms\n"
      "{}\n",
      plan.rate, f.seconds, f.pushed, f.waited, f.told, f.pushed - f.told, f.astray, f.heard,
      static_cast<std::int64_t>(f.told - f.heard), f.invalid, f.late_ms,
      whole(f) ? "none was lost" : "FAILED");
}

std::string soak_json(const SoakPlan& plan, const SoakFigures& f) {
  return fmt::format(
      "{{\"rate_hz\":{:g},\"seconds\":{:.3f},\"pushed\":{},\"waited\":{},\"told\":{},\"heard\":{},"
      "\"astray\":{},\"invalid\":{},\"late_ms\":{:.3f},\"whole\":{}}}\n",
      plan.rate, f.seconds, f.pushed, f.waited, f.told, f.heard, f.astray, f.invalid, f.late_ms,
      yes_or_no(whole(f)));
}

std::string loop_table(const std::vector<LoopSeries>& series) {
  std::string out = fmt::format(
      "{:<13}{:^27}{:^24}{:^18}{}\n{:<13}{:>9}{:>9}{:>9}{:>8}{:>8}{:>8}"
      "{:>9}{:>9}{:>7}\n",
      "[us]", "late", "work", "99.9 % grows by", "valid", "device", "median", "99.9 %", "worst",
      "median", "99.9 %", "worst", "late", "work", "[%]");
  for (const LoopSeries& one : series) {
    if (!one.missing.empty()) {
      out += fmt::format("{:<13}not tried: {}\n", one.device, one.missing);
      continue;
    }
    const LoopFigures f = loop_figures(one, series[0]);
    out += fmt::format(
        "{:<13}{:>9.1f}{:>9.1f}{:>9.1f}{:>8.1f}{:>8.1f}{:>8.1f}{:>9.1f}{:>9.1f}"
        "{:>7.1f}  {}\n",
        one.device, f.late.median, f.late.most, f.late.worst, f.work.median, f.work.most,
        f.work.worst, f.late_grows, f.work_grows, 100.0 * f.valid, grows_little(f) ? "" : "MORE");
  }
  return out + fmt::format("grows by at most {:g} us: {}\n", kMostGrowth,
                           within_growth(series) ? "yes" : "no");
}

std::string loop_json(const std::vector<LoopSeries>& series) {
  std::string out = "{\"devices\":[";
  for (const LoopSeries& one : series) {
    if (&one != &series[0]) out += ",";
    out += fmt::format("{{\"device\":\"{}\",\"behind\":\"{}\"", one.device, one.behind);
    if (!one.missing.empty()) {
      out += ",\"tried\":false}";
      continue;
    }
    const LoopFigures f = loop_figures(one, series[0]);
    out += fmt::format(
        ",\"tried\":true,\"late_us\":{},\"work_us\":{},\"late_grows_us\":{:.3f},"
        "\"work_grows_us\":{:.3f},\"valid\":{:.4f},\"engaged\":{:.4f},"
        "\"pushed\":{:.4f}}}",
        spread_json(f.late), spread_json(f.work), f.late_grows, f.work_grows, f.valid, f.engaged,
        f.pushed);
  }
  return out + fmt::format("],\"most_us\":{:g},\"within\":{}}}\n", kMostGrowth,
                           yes_or_no(within_growth(series)));
}

bool within_growth(const std::vector<LoopSeries>& series) {
  for (const LoopSeries& one : series) {
    if (one.missing.empty() && !grows_little(loop_figures(one, series[0]))) return false;
  }
  return !series.empty();
}

}  // namespace handrail::desk
