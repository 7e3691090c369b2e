// The file of one person in one experiment: a line of JSON for each trial that was begun and for
// each that ended (proto/experiment.proto), each on the disk before the next begins.
#pragma once

#include <string>
#include <vector>

#include "client/experiment/trial_order.h"
#include "proto/experiment.pb.h"
#include "server/base/status.h"

namespace handrail {

// Extension of such files, with the dot.
inline constexpr char kExperimentExtension[] = ".jsonl";

// Where a subject's file is.
std::string experiment_file(const std::string& folder, const std::string& experiment,
                            const std::string& subject);

struct ExperimentRecord {
  pb::ExperimentSubject subject;
  std::vector<pb::ExperimentTrial> trials;  // that were begun, in order
  pb::ExperimentAnswers answers;            // the newest
  bool cut = false;                         // the last line is not whole: the program was killed
  std::size_t whole = 0;                    // bytes before that
};

// What a file says. A trial that has begun and not ended was interrupted. The error names file,
// line and what is wrong with it.
Result<ExperimentRecord> read_experiment(const std::string& file);
Result<ExperimentRecord> parse_experiment(const std::string& file, const std::string& text);

// One runner's hold of the file. Others are refused as long as it lasts.
class ExperimentFile {
 public:
  ExperimentFile() = default;
  ~ExperimentFile();
  ExperimentFile(const ExperimentFile&) = delete;
  ExperimentFile& operator=(const ExperimentFile&) = delete;

  // Makes the folder and the file, or goes on with one that is there if `resume`. `subject` is
  // written into a new file; one to go on with has to be of the same experiment and person,
  // simulated or not. `out` is what it says so far. The error says what to do.
  Status open(const std::string& file, const pb::ExperimentSubject& subject, bool resume,
              ExperimentRecord& out);
  // On the disk when it returns. After an error the file is as before.
  Status append(const pb::ExperimentLine& line);

 private:
  std::string path_;
  int fd_ = -1;
};

// A line as it is written, with its end.
std::string line_of(const pb::ExperimentLine& line);

}  // namespace handrail
