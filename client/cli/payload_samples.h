// Samples of a payload calibration as a CSV file, so that a fit can be had again.
//
// First line `qw,qx,qy,qz,fx_n,fy_n,fz_n,tx_n_m,ty_n_m,tz_n_m`: orientation of the tip in the
// robot's base and what the sensor read, in the tip's axes, about the tip. Optionally followed by
// `,force_noise_n,torque_noise_n_m`: standard deviation of these means, each axis; else 0. One row
// an orientation; empty lines and Windows line ends are fine.
#pragma once

#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/task/payload_fit.h"

namespace handrail {

// Errors: "FILE:LINE:COLUMN: what is wrong, what was expected". Columns count bytes from 1.
Result<std::vector<PayloadSample>> load_payload_samples(const std::string& path);
// `place` stands for the file in errors.
Result<std::vector<PayloadSample>> parse_payload_samples(const std::string& place,
                                                         const std::string& text);

// Such a file, with noise.
std::string payload_samples_text(const std::vector<PayloadSample>& samples);

}  // namespace handrail
