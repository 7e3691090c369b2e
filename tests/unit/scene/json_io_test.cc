#include "server/scene/json_io.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/text_format.h>

#include <memory>

#include "proto/operator.pb.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Json, CountersOfAStatusAreNumbersAndHashesTexts) {
  pb::Status status;
  status.set_ticks(9007199254740991);  // 2^53 - 1
  status.set_log_lost(0);
  const std::string line = json_text(status, false);
  EXPECT_THAT(line, HasSubstr("\"ticks\":9007199254740991,"));
  EXPECT_THAT(json_text(status, true), HasSubstr("\"ticks\": 9007199254740991,"));
  EXPECT_THAT(json_of_set_fields(status, false), HasSubstr("\"ticks\":9007199254740991,"));
  // Every counter there is.
  const google::protobuf::Descriptor& type = *status.GetDescriptor();
  int counters = 0;
  for (int i = 0; i < type.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *type.field(i);
    const std::string key = '"' + field.name() + "\":";
    if (field.type() != google::protobuf::FieldDescriptor::TYPE_UINT64) continue;
    EXPECT_THAT(line, HasSubstr(key));
    EXPECT_THAT(line, Not(HasSubstr(key + '"')));
    ++counters;
  }
  EXPECT_GE(counters, 6);
}

// A message made up for the test: names that mean one thing here and another there.
class OwnMessage : public ::testing::Test {
 protected:
  OwnMessage() {
    google::protobuf::FileDescriptorProto file;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
        R"(name: "own.proto" syntax: "proto2"
           message_type { name: "Outer"
             field { name: "count" number: 1 type: TYPE_UINT64 label: LABEL_OPTIONAL }
             field { name: "inner" number: 2 type: TYPE_MESSAGE type_name: "Inner"
                     label: LABEL_REPEATED }
             field { name: "counts" number: 3 type: TYPE_UINT64 label: LABEL_REPEATED }
             field { name: "note" number: 4 type: TYPE_STRING label: LABEL_OPTIONAL }
             field { name: "hash" number: 5 type: TYPE_FIXED64 label: LABEL_OPTIONAL } }
           message_type { name: "Inner"
             field { name: "count" number: 1 type: TYPE_STRING label: LABEL_OPTIONAL }
             field { name: "note" number: 2 type: TYPE_UINT64 label: LABEL_OPTIONAL } })",
        &file));
    pool_.BuildFile(file);
  }
  std::string json_of(const std::string& text, bool pretty) {
    const google::protobuf::Descriptor* type = pool_.FindMessageTypeByName("Outer");
    const std::unique_ptr<google::protobuf::Message> message(factory_.GetPrototype(type)->New());
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, message.get()));
    return json_of_set_fields(*message, pretty);
  }
  google::protobuf::DescriptorPool pool_;
  google::protobuf::DynamicMessageFactory factory_{&pool_};
};

TEST_F(OwnMessage, ATextOfACountersNameStaysAText) {
  EXPECT_EQ(json_of(R"(count: 12 inner { count: "34" note: 5 } inner { count: "6" } counts: 7
                       counts: 8 note: "9" hash: 10)",
                    false),
            R"({"count":12,"inner":[{"count":"34","note":5},{"count":"6"}],"counts":[7,8],)"
            R"("note":"9","hash":"10"})");
  EXPECT_EQ(json_of("inner { } count: 1", true), "{\n \"count\": 1,\n \"inner\": [\n  {}\n ]\n}");
  EXPECT_EQ(json_of("", false), "{}");
}

TEST_F(OwnMessage, ATextThatLooksLikeACounterStaysAsItIs) {
  EXPECT_EQ(json_of(R"(inner { count: "\"count\": \"1\"}]," } note: "\"count\":\"2\"\\" count: 3)",
                    false),
            R"({"count":3,"inner":[{"count":"\"count\": \"1\"}],"}],)"
            R"("note":"\"count\":\"2\"\\"})");
}

}  // namespace
}  // namespace handrail
