// CSV files of payload calibrations, and the fit of what they hold.
#include "client/cli/payload_samples.h"
#include "tests/fuzz/expect_error.h"

namespace handrail {

HANDRAIL_FUZZ(payload_samples) {
  const std::string text(fuzz::text_of(bytes));
  const auto samples = parse_payload_samples("samples.csv", text);
  if (!samples) return fuzz::require_error_at("samples.csv:", samples.message());
  for (const PayloadSample& s : *samples) {
    const Vec3 &f = s.raw_T.force, &t = s.raw_T.torque;
    fuzz::require(is_unit(s.q_ST, 1e-9), "an orientation is one");
    fuzz::require(f.cwiseAbs().maxCoeff() <= 1e6 && t.cwiseAbs().maxCoeff() <= 1e6,
                  "readings are within their range");
    fuzz::require(s.force_noise >= 0.0 && s.torque_noise >= 0.0, "a noise is not negative");
  }
  const auto again = parse_payload_samples("again.csv", payload_samples_text(*samples));
  fuzz::require(again.is_ok() && again->size() == samples->size(), "what is written can be read");
  const Result<PayloadFit> fit = fit_payload(*samples);
  if (!fit) return fuzz::require(!fit.message().empty(), "an error says what");
  fuzz::require(fit->payload.mass >= 0.0 && fit->payload.centre_T.allFinite() &&
                    is_finite(fit->payload.bias_T),
                "a payload that is found is one");
}

}  // namespace handrail
