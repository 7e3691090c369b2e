#include "server/lab/links/link_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "server/base/units.h"
#include "server/lab/faults/fault_run.h"
#include "server/lab/links/stroke_speed.h"
#include "server/lab/study/parallel.h"
#include "server/session/hold_count.h"

namespace handrail {
namespace {

Nanos nanos(double ms) { return static_cast<Nanos>(ms * 1e6); }

LinkFaults faults_of(const LinkCase& link) {
  LinkFaults faults;
  faults.delay = nanos(link.delay_ms);
  faults.jitter = nanos(link.jitter_ms);
  faults.loss = link.loss;
  faults.reorder = link.in_order ? 0.0 : 1.0;
  return faults;
}

bool over(FaultRun& run) {
  const SessionState session = run.cell().master_state().lead.session;
  return session == SessionState::kOff || session == SessionState::kFault;
}

void drive_hand(FaultRun& run, Nanos span, LinkFigures& out) {
  HoldCount count;
  int ends = 0;
  bool was_over = false;
  for (Nanos t = 0; t < span; t += kMillisecond) {
    run.drive(kMillisecond);
    ends += over(run) && !was_over;
    was_over = over(run);
    const SlaveState& slave = run.cell().slave();
    count.step(kMillisecond, was_over ? SessionState::kOff : slave.state, slave.reason);
  }
  const double minutes = to_seconds(span) / 60.0;
  out.holds = count.times() / minutes;
  out.ends = ends / minutes;
  out.held = to_seconds(count.held()) / to_seconds(span);
  out.longest = to_seconds(count.longest()) * 1e3;
  out.behind = run.tracking_error() / kMm;
}

// A run of its own, so that all strokes are about the place where the arm starts.
double stroke_speed(const LinkCase& link, std::uint64_t& violations) {
  FaultRun run({.seed = link.seed});
  run.let_hold();
  double side = 0.0;
  run.layers().hand = [&side](Nanos, HandReading& hand) {
    hand.X_MH = Pose();
    hand.X_MH.p.x() = side;
    hand.v_MH.setZero();
  };
  run.set_network(faults_of(link));
  if (!run.engage()) return 0.0;
  const Nanos span = StrokeSpeed::kStrokeTime + 2 * nanos(link.delay_ms + link.jitter_ms);
  StrokeSpeed speed;
  std::vector<Vec3> tip;
  for (int i = 0; i <= StrokeSpeed::kStrokes; ++i) {
    side = i % 2 == 0 ? StrokeSpeed::kHalfStroke : -StrokeSpeed::kHalfStroke;
    tip.clear();
    for (Nanos t = 0; t < span; t += kMillisecond) {
      run.drive(kMillisecond);
      tip.push_back(run.auditor().tip());
    }
    if (i > 0) speed.add(tip, 1e-3);  // the first is half a stroke
  }
  violations += run.outcome().violations;
  return speed.mean() / kMm;
}

LinkCell summary(const LinkCase& link, std::span<const LinkFigures> runs) {
  LinkCell cell{link, {}, static_cast<int>(runs.size())};
  LinkFigures& sum = cell.figures;
  for (const LinkFigures& run : runs) {
    sum.violations = std::max(sum.violations, run.violations);
    if (!run.engaged) continue;
    ++cell.runs_engaged;
    sum.engaged = true;
    sum.after = std::max(sum.after, run.after);
    sum.longest = std::max(sum.longest, run.longest);
    sum.holds += run.holds;
    sum.held += run.held;
    sum.ends += run.ends;
    sum.behind += run.behind;
    sum.speed += run.speed;
  }
  for (double* mean : {&sum.holds, &sum.held, &sum.ends, &sum.behind, &sum.speed}) {
    *mean /= std::max(cell.runs_engaged, 1);
  }
  return cell;
}

// "1.1 s, 96 %, 13 x 4 ms"; "2 of 5: " before it where not every seed engaged.
std::string cell_text(const LinkCell& cell, double best) {
  const LinkFigures& f = cell.figures;
  if (!f.engaged) return "refused";
  std::string out;
  if (cell.runs_engaged < cell.runs) out = fmt::format("{} of {}: ", cell.runs_engaged, cell.runs);
  out.append(fmt::format("{:.1f} s, {:.0f} %, ", f.after, 100.0 * f.speed / best));
  if (f.holds < 0.5) return out.append("none");
  const double held_ms = f.held * 60e3;  // a minute
  out.append(fmt::format("{:.0f} x {:.0f} ms", f.holds, held_ms / f.holds));
  if (f.ends > 0.0) out.append(fmt::format(", {:.0f} ends", std::ceil(f.ends)));
  return out;
}

}  // namespace

LinkFigures measure_link(const LinkCase& link, Nanos drive) {
  constexpr double kEngageRuns = 1.0;  // FaultRun::engage() goes on for so long [s]
  LinkFigures out;
  FaultRun run({.seed = link.seed});
  run.let_hold();
  run.set_network(faults_of(link));
  out.engaged = run.engage();
  if (out.engaged) {
    out.after = to_seconds(run.now()) - kEngageRuns;
    drive_hand(run, drive, out);
    out.speed = stroke_speed(link, out.violations);
  }
  out.violations += run.outcome().violations;
  return out;
}

std::vector<LinkCase> link_cases(const LinkMapOptions& options) {
  std::vector<LinkCase> cases;
  for (const double delay : options.delays_ms) {
    for (const double jitter : options.jitters_ms) {
      if (jitter > delay) continue;  // nothing comes before it was sent
      for (const double loss : options.losses) {
        cases.push_back({delay, jitter, loss, options.in_order, 1});
      }
    }
  }
  return cases;
}

std::vector<LinkCell> run_link_map(const LinkMapOptions& options) {
  const std::vector<LinkCase> cases = link_cases(options);
  const auto seeds = static_cast<std::size_t>(options.seeds);
  std::vector<LinkFigures> runs(cases.size() * seeds);
  const bool done = run_parallel(
      runs.size(), options.threads,
      [&](std::size_t i) {
        LinkCase link = cases[i / seeds];
        link.seed = 1 + i % seeds;
        runs[i] = measure_link(link, options.drive);
      },
      [&](std::size_t n) {
        if (options.progress) options.progress(n, runs.size());
      },
      options.cancelled);
  std::vector<LinkCell> cells;
  for (std::size_t i = 0; done && i < cases.size(); ++i) {
    cells.push_back(summary(cases[i], std::span(runs).subspan(i * seeds, seeds)));
  }
  return cells;
}

std::string link_table(const LinkMapOptions& options, const std::vector<LinkCell>& cells) {
  const auto first = std::find_if(cells.begin(), cells.end(),
                                  [](const LinkCell& c) { return c.figures.speed > 0.0; });
  const double best = first == cells.end() ? 1.0 : first->figures.speed;
  std::string out = fmt::format(
      "engaged after, the tip's speed ({:.0f} mm/s is 100 %), holds a minute and their mean\n\n"
      "| delay +- jitter, ms |",
      best);
  std::string line = "|---|";
  for (const double loss : options.losses) {
    out += fmt::format(" loss {:g} % |", 100.0 * loss);
    line.append("---|");
  }
  out += "\n" + line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const LinkCase& link = cells[i].link;
    if (i % options.losses.size() == 0) {
      out += fmt::format("\n| {:g} +- {:g} |", link.delay_ms, link.jitter_ms);
    }
    out += fmt::format(" {} |", cell_text(cells[i], best));
  }
  return out + "\n";
}

std::string link_json(const std::vector<LinkCell>& cells) {
  std::string out = "{\"cells\": [";
  for (const LinkCell& cell : cells) {
    const LinkFigures& f = cell.figures;
    out += fmt::format(
        "{}\n  {{\"delay_ms\": {:g}, \"jitter_ms\": {:g}, \"loss\": {:g}, \"in_order\": {}, "
        "\"runs\": {}, \"engaged\": {}, \"engaged_after_s\": {:.3f}, \"speed_mm_s\": {:.1f}, "
        "\"holds_per_minute\": {:.2f}, \"held_share\": {:.5f}, \"longest_hold_ms\": {:.0f}, "
        "\"ends_per_minute\": {:.2f}, \"behind_mm\": {:.3f}, \"violations\": {}}}",
        &cell == cells.data() ? "" : ",", cell.link.delay_ms, cell.link.jitter_ms, cell.link.loss,
        cell.link.in_order, cell.runs, cell.runs_engaged, f.after, f.speed, f.holds, f.held,
        f.longest, f.ends, f.behind, f.violations);
  }
  return out + "\n]}\n";
}

}  // namespace handrail
