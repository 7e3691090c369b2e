#include "client/cli/calibrate_command.h"

#include <poll.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "client/cli/interrupt.h"
#include "client/cli/payload_samples.h"
#include "client/cli/vector_text.h"
#include "proto/calibration.pb.h"
#include "server/base/output.h"
#include "server/scene/json_io.h"
#include "server/scene/payload_io.h"
#include "server/task/payload_sampler.h"

namespace handrail {
namespace {

constexpr int kSampleRefreshMs = 20;
constexpr Nanos kCalibratePatience = 2 * kSecond;
constexpr double kOldest_ms = 100.0;  // of what the slave says
constexpr double kMostPoses = 50.0;

using Samples = std::vector<PayloadSample>;

template <typename... Values>
std::string text_of(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

ExitCode refuse(const Console& console, const std::string& text) {
  console.err << "handrail: " << text << '\n';
  return kExitRefused;
}

Vec3 vector_of(const google::protobuf::RepeatedField<double>& v) { return {v[0], v[1], v[2]}; }

Quat turn_of(const pb::PoseMm& pose) {
  const auto& q = pose.quaternion();
  return Quat(q[0], q[1], q[2], q[3]);
}

// Why this status says nothing about the sensor; empty when it does.
std::string why_unknown(const pb::Status& s) {
  if (s.tip().quaternion_size() != 4) return "no slave with an arm";
  if (!(s.packet_age_ms() >= 0.0 && s.packet_age_ms() < kOldest_ms)) return "the slave is silent";
  if (!s.has_contact_force() || s.contact_force_n_size() != 3 || s.contact_torque_n_m_size() != 3) {
    return "no sound reading of the force sensor";
  }
  return {};
}

// What has to be changed first; null: nothing.
const char* why_not_now(const pb::Status& s) {
  if (s.payload_removed()) {
    return "the slave already takes a payload out of its readings: start it without the payload "
           "block in its file, then calibrate";
  }
  if (s.mounted()) {
    return "the scene mounts the tool aside, and the payload is in the flange's axes: load a scene "
           "without robot { mount }, then calibrate";
  }
  return nullptr;
}

// The slave turns the wrench with the measured orientation.
PayloadReading reading_of(const pb::Status& s) {
  const Quat q_TS = turn_of(s.tip()).conjugate();
  return {s.time_s(),
          {vector_of(s.tip().position_mm()) * kMm, turn_of(s.tip())},
          {q_TS * vector_of(s.contact_force_n()), q_TS * vector_of(s.contact_torque_n_m())}};
}

// What the person does now and what is wanted next, on one line that is written again and again.
class Progress {
 public:
  explicit Progress(const Console& console) : console_(console) {}
  // On a terminal only.
  void now(const std::string& text) {
    if (!console_.err_is_terminal || text == last_) return;
    last_ = text;
    console_.err << "\r\033[K" << text << std::flush;
  }
  void line(const std::string& text) {
    if (console_.err_is_terminal) console_.err << "\r\033[K";
    console_.err << text << std::endl;
    last_.clear();
  }

 private:
  const Console& console_;
  std::string last_;
};

std::string advice(PayloadSampler::State state, const PayloadSampler& sampler, bool alike) {
  const char* lean = alike ? ", to another side" : "";
  switch (state) {
    case PayloadSampler::State::kStanding:
      return text_of("standing: %.1f of %.0f s", sampler.stood(), PayloadSampler::kStand);
    case PayloadSampler::State::kMoving:
      return text_of(
          "does not count: moved by %.1f mm and %.1f deg, expected at most %.0f mm and %.1f deg "
          "for %.0f s; clutch in when the hand cannot",
          sampler.moved() / kMm, sampler.moved_turn() / kDeg, PayloadSampler::kStill / kMm,
          PayloadSampler::kStillTurn / kDeg, PayloadSampler::kStand);
    default:
      return text_of("does not count: %.0f deg from the nearest sample%s, expected %.0f; tilt on",
                     sampler.turned() / kDeg, lean, PayloadSampler::kTurn / kDeg);
  }
}

// Samples of the running system; kExitDone when there are enough. What there is is in `out` in any
// case.
ExitCode watch(const Options& options, const Console& console, std::size_t wanted, Samples& out) {
  OperatorClient client(options.master, options.as);
  pb::Request request;
  request.set_status(true);
  catch_interrupts();
  PayloadSampler sampler;
  Progress progress(console);
  bool told = false;
  for (;;) {
    const Result<pb::Reply> reply = client.call(request, kCalibratePatience);
    if (interrupted() || !console.err) {
      progress.line(text_of("stopped after %zu of %zu orientations", out.size(), wanted));
      return kExitInterrupted;
    }
    if (const ExitCode code = exit_code(reply); code != kExitDone) {
      progress.line("handrail: " +
                    (reply ? "refused: " + reply->reason() : std::string(reply.message())));
      return code;
    }
    const pb::Status& status = reply->status();
    if (const std::string problem = why_unknown(status); !problem.empty()) {
      sampler.interrupt();
      progress.now("waiting: " + problem);
    } else if (const char* why = why_not_now(status)) {
      return refuse(console, why);
    } else {
      if (!told) {
        progress.line(text_of(
            "Touching nothing, tilt the tip to %zu orientations, each by %.0f deg or more to "
            "another side, and let it stand for a second in each. Ctrl-C ends.",
            wanted, PayloadSampler::kTurn / kDeg));
        told = true;
      }
      const PayloadSampler::State state = sampler.add(reading_of(status));
      const Samples& samples = sampler.samples();
      const bool alike = samples.size() >= wanted && payload_spread(samples) < kLeastPayloadSpread;
      if (state == PayloadSampler::State::kTaken) {
        const Vec3& f = samples.back().raw_T.force;
        out = samples;
        progress.line(text_of("%zu of %zu: the sensor reads %.2f %.2f %.2f N%s", samples.size(),
                              wanted, f.x(), f.y(), f.z(),
                              alike ? "; too much alike yet, tilt to another side" : ""));
        if (samples.size() >= wanted && !alike) return kExitDone;
      }
      progress.now(advice(state, sampler, alike));
    }
    ::poll(nullptr, 0, kSampleRefreshMs);
  }
}

pb::PayloadCalibration report_of(const PayloadFit& fit, const Samples& samples) {
  pb::PayloadCalibration out;
  *out.mutable_payload() = payload_config(fit.payload);
  out.set_force_left_n(fit.force_left);
  out.set_torque_left_n_m(fit.torque_left);
  for (const PayloadSample& s : samples) {
    pb::PayloadCalibration::Sample& row = *out.add_sample();
    for (const double c : {s.q_ST.w(), s.q_ST.x(), s.q_ST.y(), s.q_ST.z()}) row.add_quaternion(c);
    row.mutable_force_n()->Add(s.raw_T.force.begin(), s.raw_T.force.end());
    row.mutable_torque_n_m()->Add(s.raw_T.torque.begin(), s.raw_T.torque.end());
    row.set_force_left_n(fit.payload.remove(s.raw_T, s.q_ST).force.norm());
  }
  return out;
}

std::string table_of(const PayloadFit& fit, const Samples& samples) {
  const Payload& p = fit.payload;
  const Vec3 c = p.centre_T / kMm;
  const Vec3 &f = p.bias_T.force, &t = p.bias_T.torque;
  return text_of("mass      %.4f kg\n", p.mass) +
         text_of("centre    %.2f %.2f %.2f mm from the tip\n", c.x(), c.y(), c.z()) +
         text_of("bias      %.3f %.3f %.3f N   %.5f %.5f %.5f N m\n", f.x(), f.y(), f.z(), t.x(),
                 t.y(), t.z()) +
         text_of("left over %.3f N, %.5f N m (RMS of %zu orientations)\n", fit.force_left,
                 fit.torque_left, samples.size());
}

// A file that is there already is not overwritten: it may be the slave's own.
Status check_new(const char* flag, const std::optional<std::string>& path) {
  std::error_code error;
  if (!path || !std::filesystem::exists(*path, error)) return Status::ok();
  return Status::error(std::string(flag) + ": " + *path + " is there already, expected a new file");
}

}  // namespace

ExitCode run_calibrate_payload(const Options& o, const Console& console) {
  const double fewest = static_cast<double>(kFewestPayloadSamples);
  const Result<double> poses =
      parse_number("--poses", o.poses.value_or("6"), fewest, kMostPoses, "orientations");
  if (!poses) return complain(console, poses.message());
  if (std::floor(*poses) != *poses) {
    return complain(console, "--poses: '" + *o.poses + "': expected a whole number");
  }
  if (o.from && o.poses) return complain(console, "--poses is for a running arm, not for --from");
  for (const Status& s : {check_new("--out", o.out), check_new("--record", o.record)}) {
    if (!s) return complain(console, s.message());
  }
  // Known before a person turns the arm for minutes.
  std::optional<NewFile> out, record;
  if (o.out) out.emplace(*o.out);
  if (o.record) record.emplace(*o.record);
  for (const auto* file : {&out, &record}) {
    if (*file && !(*file)->opened()) return complain(console, (*file)->opened().message());
  }
  Samples samples;
  ExitCode watched = kExitDone;
  if (o.from) {
    Result<Samples> loaded = load_payload_samples(*o.from);
    if (!loaded) return complain(console, loaded.message());
    samples = std::move(*loaded);
  } else {
    watched = watch(o, console, static_cast<std::size_t>(*poses), samples);
  }
  // Also when they are none of a calibration, or too few: they show why.
  if (record && !samples.empty()) {
    if (const Status s = record->finish(payload_samples_text(samples)); !s) {
      return complain(console, s.message());
    }
  }
  if (watched != kExitDone) {
    if (o.record && !samples.empty()) console.err << "kept in " << *o.record << '\n';
    return watched;
  }
  const Result<PayloadFit> fit = fit_payload(samples);
  if (!fit) return refuse(console, (o.from ? *o.from + ": " : "") + fit.message());
  if (fit->payload.mass > 10.0) {
    return refuse(console, text_of("%.2f kg are no payload for this arm, expected at most 10 kg: "
                                   "check the sensor's counts_per_n",
                                   fit->payload.mass));
  }
  const std::string block = payload_text(fit->payload);
  if (out) {
    if (const Status s = out->finish(block); !s) return complain(console, s.message());
  }
  if (o.json) {
    console.out << json_text(report_of(*fit, samples), true) << '\n';
    return kExitDone;
  }
  console.out << table_of(*fit, samples) << '\n'
              << (o.out ? "for the file of handrail-slave, written to " + *o.out + ":\n"
                        : std::string("for the file of handrail-slave:\n"))
              << block;
  return kExitDone;
}

}  // namespace handrail
