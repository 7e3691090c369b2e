// The master's status, as an experiment takes it.
#pragma once

#include <vector>

#include "client/api/operator_client.h"
#include "client/experiment/linear_live.h"
#include "client/experiment/simulated_subject.h"
#include "client/experiment/trace_csv.h"
#include "client/experiment/way_to_a.h"
#include "proto/operator.pb.h"

namespace handrail {

Result<pb::Status> status_of(OperatorClient& client, Nanos patience);

// What holds the arm while it is led; "none" else.
std::string holds(const pb::Status& now);

// Three numbers; zeros where the master says nothing.
Vec3 vector_of(const google::protobuf::RepeatedField<double>& v);

LiveSample sample_of(const pb::Status& now);
SubjectSight sight_of(const pb::Status& now);
StartSight start_of(const pb::Status& now);
TraceRow row_of(const pb::Status& now, LinearPhase phase);

}  // namespace handrail
