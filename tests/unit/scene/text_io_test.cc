#include "server/scene/text_io.h"
#include "server/base/read_file.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/config.pb.h"
#include "proto/scene.pb.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

std::string text_error_of(const std::string& text) {
  pb::Scene scene;
  TextSource source;
  return source.parse("f.scene", text, scene).message();
}

TEST(TextSource, ReadsWhatIsRight) {
  pb::Scene scene;
  TextSource source;
  ASSERT_TRUE(source.parse("f.scene", "name: 'a' # comment\nmapping { scale: 3 }", scene).is_ok());
  EXPECT_EQ(scene.name(), "a");
  EXPECT_EQ(scene.mapping().scale(), 3.0);
}

TEST(TextSource, PlacesAValueOutOfRange) {
  EXPECT_EQ(text_error_of("name: 'a'\nguidance {\n  stiffness_n_mm: 12\n}"),
            "f.scene:3:3: field 'guidance.stiffness_n_mm': 12 is outside 0 to 10 N/mm");
}

TEST(TextSource, CountsATabAsOneColumn) {
  EXPECT_EQ(text_error_of("name: 'a'\nguidance {\n\t \tstiffness_n_mm: 12\n}"),
            "f.scene:3:4: field 'guidance.stiffness_n_mm': 12 is outside 0 to 10 N/mm");
}

TEST(TextSource, RefusesNanAndInfinity) {
  EXPECT_EQ(text_error_of("name: 'a' guidance { delta_mm: nan }"),
            "f.scene:1:22: field 'guidance.delta_mm': nan is not a finite number");
  EXPECT_EQ(text_error_of("name: 'a' guidance { delta_mm: 1e999 }"),
            "f.scene:1:22: field 'guidance.delta_mm': inf is not a finite number");
}

TEST(TextSource, SuggestsTheFieldMeantByAWrongUnit) {
  EXPECT_EQ(text_error_of("guidance {\n\tstiffness_n_m: 1\n}"),
            "f.scene:2:2: field 'guidance.stiffness_n_m': no such field; did you mean "
            "'stiffness_n_mm'?");
}

TEST(TextSource, ListsTheFieldsWhenNoneIsNear) {
  EXPECT_EQ(text_error_of("smoother { zzzzzz: 1 }"),
            "f.scene:1:12: field 'smoother.zzzzzz': no such field; expected one of form, samples");
}

TEST(TextSource, RefusesAKeyGivenTwice) {
  EXPECT_EQ(text_error_of("name: 'a'\nname: 'b'"), "f.scene:2:1: field 'name': given twice");
  EXPECT_EQ(text_error_of("mapping { }\nmapping { }"), "f.scene:2:1: field 'mapping': given twice");
}

TEST(TextSource, NamesTheValuesOfABoolean) {
  EXPECT_EQ(text_error_of("name: 'a' guidance { local_surface: maybe }"),
            "f.scene:1:37: field 'guidance.local_surface': maybe is not one of true, false");
  EXPECT_EQ(text_error_of("name: 'a' guidance { local_surface: \"may be\" }"),
            "f.scene:1:37: field 'guidance.local_surface': \"may be\" is not one of true, false");
  EXPECT_EQ(text_error_of("name: 'a' guidance { local_surface: 7 }"),
            "f.scene:1:37: field 'guidance.local_surface': 7 is not one of true, false");
  EXPECT_EQ(text_error_of("name: 'a' guidance { local_surface: 'maybe"),
            "f.scene:1:43: field 'guidance.local_surface': unexpected end of string");
  // Behind the value a name is missed, no value.
  EXPECT_EQ(text_error_of("name: 'a' guidance { local_surface: true 7 }"),
            "f.scene:1:42: field 'guidance.local_surface': expected a field's name, got: 7");
}

TEST(TextSource, NamesTheValuesOfAnEnumeration) {
  EXPECT_EQ(text_error_of("guidance { method: FAST }"),
            "f.scene:1:20: field 'guidance.method': FAST is not one of EXACT, PUBLISHED");
  EXPECT_EQ(text_error_of("guidance { method: 'FAST' }"),
            "f.scene:1:20: field 'guidance.method': 'FAST' is not one of EXACT, PUBLISHED");
}

TEST(TextSource, SaysWhichTypeAFieldHas) {
  EXPECT_EQ(text_error_of("name: 7"), "f.scene:1:7: field 'name': expected string, got: 7");
  EXPECT_EQ(text_error_of("mapping { scale: \"2\" }"),
            "f.scene:1:18: field 'mapping.scale': expected double, got: \"2\"");
  EXPECT_EQ(text_error_of("smoother { samples: -1 }"),
            "f.scene:1:21: field 'smoother.samples': expected integer, got: -");
  EXPECT_EQ(
      text_error_of("mapping { scale: 2"),
      "f.scene:1:19: field 'mapping.scale': expected a field's name, got: the end of the file");
}

TEST(TextSource, PlacesListsAndTheirElements) {
  EXPECT_EQ(text_error_of("name: 'a'\ntool { kind: POINT at_mm: [1, 2] }"),
            "f.scene:2:20: field 'tool[0].at_mm': 2 values, expected 3");
  EXPECT_EQ(
      text_error_of("name: 'a' tool { kind: POINT }\ntool { kind: POINT at_mm: [1, 2, 9e3] }"),
      "f.scene:2:20: field 'tool[1].at_mm[2]': 9000 is outside -5000 to 5000 mm");
  EXPECT_EQ(text_error_of("name: 'a' tool { kind: POINT }\ntool { }"),
            "f.scene:2:1: field 'tool[1].kind': missing, but required");
}

TEST(TextSource, AnswersDeepNestingWithOneLine) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += "tool { ";
  EXPECT_EQ(text_error_of(text).substr(0, 40), "f.scene:1:8: field 'tool.tool': no such ");
}

TEST(TextSource, WritesNothingToStandardError) {
  testing::internal::CaptureStderr();
  text_error_of("bogus: 1");
  text_error_of("name: 'a' guidance { delta_mm: inf }");
  text_error_of("}{");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Whatever the text, an error is one line that starts with file and line.
void expect_a_clear_answer(const std::string& text) {
  const std::string error = text_error_of(text);
  RC_ASSERT(error.empty() || error.starts_with("f.scene:"));
  RC_ASSERT(error.find('\n') == std::string::npos);
}

RC_GTEST_PROP(TextSourceProperty, AnyBytesGetOneClearLine, (const std::string& text)) {
  expect_a_clear_answer(text);
}

RC_GTEST_PROP(TextSourceProperty, WordsOfTheFormatInAnyOrderGetOneClearLine, ()) {
  const auto words =
      *rc::gen::container<std::vector<std::string>>(rc::gen::elementOf(std::vector<std::string>{
          "name", ":", "'a'", "{",  "}",   "guidance",  "tool",   "kind", "LINE", "[",
          "]",    ",", "1",   "-",  "nan", "1e999",     "at_mm",  "#",    "\n",   "\"",
          "<",    ">", ";",   "\t", "0x",  "direction", "bumper", "\xff"}));
  std::string text;
  for (const std::string& word : words) text += word + " ";
  expect_a_clear_answer(text);
}

RC_GTEST_PROP(TextSourceProperty, ADamagedSceneGetsOneClearLine, ()) {
  std::string text =
      "name: 'a'\nguidance { method: EXACT stiffness_n_mm: 0.8 }\n"
      "tool { kind: LINE direction: [1, 0, 0] at_mm: [1, 2, 3] end_mm: [9, 2, 3] }\n";
  const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
  const auto length = *rc::gen::inRange<std::size_t>(0, 6);
  text.replace(at, length, *rc::gen::arbitrary<std::string>());
  expect_a_clear_answer(text);
}

TEST(ReadFile, NamesPathAndCause) {
  const TempFolder folder;
  EXPECT_EQ(read_file(folder.path() + "/none", 10).message(),
            folder.path() + "/none: cannot open: No such file or directory");
  EXPECT_EQ(read_file(folder.path(), 10).message(),
            folder.path() + ": is a directory, expected a file");
  EXPECT_EQ(read_file("/dev/zero", 10).message(), "/dev/zero: not a regular file");
}

TEST(ReadFile, DoesNotWaitForAPipe) {
  const TempFolder folder;
  const std::string pipe = folder.path() + "/pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read_file(pipe, 10).message(), pipe + ": not a regular file");
}

TEST(ReadFile, RefusesAFileItMayNotRead) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TempFolder folder;
  const std::string file = folder.write("secret", "x");
  ASSERT_EQ(::chmod(file.c_str(), 0), 0);
  EXPECT_EQ(read_file(file, 10).message(), file + ": cannot open: Permission denied");
}

TEST(ReadFile, TakesExactlyTheBytesAllowed) {
  const TempFolder folder;
  const std::string file = folder.write("f", "0123456789");
  ASSERT_TRUE(read_file(file, 10).is_ok());
  EXPECT_EQ(*read_file(file, 10), "0123456789");
  EXPECT_EQ(read_file(file, 9).message(), file + ": larger than the 9 bytes allowed");
}

}  // namespace
}  // namespace handrail
