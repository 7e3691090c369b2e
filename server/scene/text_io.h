// Reads protobuf text files and says exactly where and why one is wrong.
#pragma once

#include <google/protobuf/text_format.h>

#include <memory>
#include <string>
#include <string_view>

#include "server/base/status.h"
#include "server/scene/field_check.h"

namespace handrail {

// One text-format file: its message's values and where each of them stands.
class TextSource {
 public:
  static constexpr std::size_t kMaxBytes = 1 << 20;

  // Reads and parses the file, then checks every field's range. All errors are one line:
  // "FILE:LINE:COLUMN: field 'a.b': what is wrong". Columns count bytes from 1.
  Status load(const std::string& path, google::protobuf::Message& out);
  // The same for text already in memory; `place` stands for the file's name in errors.
  Status parse(const std::string& place, std::string_view text, google::protobuf::Message& out);

  // An error in load's form at a field of the message last parsed, for checks beyond ranges. A
  // field that the file does not mention is placed at the message that lacks it.
  Status error_at(const FieldProblem& problem) const;

 private:
  std::size_t offset_of(int line, int column) const;
  std::string position(std::size_t offset) const;
  std::string explain(std::string message, std::size_t& offset) const;

  std::string place_;
  std::string text_;
  const google::protobuf::Descriptor* type_ = nullptr;
  std::unique_ptr<google::protobuf::TextFormat::ParseInfoTree> tree_;
};

}  // namespace handrail
