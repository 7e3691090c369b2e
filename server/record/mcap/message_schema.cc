#include "server/record/mcap/message_schema.h"

#include <google/protobuf/descriptor.pb.h>

#include <set>

namespace handrail {
namespace {

void add_file(const google::protobuf::FileDescriptor& file, std::set<std::string>& seen,
              google::protobuf::FileDescriptorSet& out) {
  if (!seen.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), seen, out);
  file.CopyTo(out.add_file());
}

}  // namespace

std::string schema_of(const google::protobuf::Descriptor& type) {
  google::protobuf::FileDescriptorSet files;
  std::set<std::string> seen;
  add_file(*type.file(), seen, files);
  return files.SerializeAsString();
}

}  // namespace handrail
