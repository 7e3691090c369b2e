// A protobuf message's description, as files and viewers take it.
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>

namespace handrail {

// A FileDescriptorSet of the type's file and all that it imports, what is imported first.
std::string schema_of(const google::protobuf::Descriptor& type);

}  // namespace handrail
