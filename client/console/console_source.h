// Where what pages and viewers see comes from: a master, or a recording.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/console/console_app.h"
#include "client/console/console_args.h"
#include "client/console/gateway/page_desk.h"
#include "client/console/gateway/web.h"
#include "client/console/viewer/viewer_desk.h"
#include "proto/console.pb.h"
#include "server/base/status.h"

namespace handrail {

// In the gateway's thread, but for the threads that it has itself; those tell what they have by
// `post`, so that nothing comes before the gateway runs.
class ConsoleSource {
 public:
  using Post = std::function<void(std::function<void()>)>;

  virtual ~ConsoleSource() = default;
  virtual PageDesk& desk() = 0;
  // Who is told of scenes; before the gateway runs.
  virtual void show_to(ConsoleApp& app) = 0;
  // Other keys count from now on.
  virtual void renew() {}
  // What is shown is a recording, and this one; null: it is live.
  virtual const pb::RecordingNews* recording() const { return nullptr; }
};

// `pages` and `viewers` must outlive it.
std::unique_ptr<ConsoleSource> live_source(const ConsoleArgs& args, ConsoleSource::Post post,
                                           PageSink& pages, ViewerDesk& viewers);
// The error names the file, the place and what was expected.
Result<std::unique_ptr<ConsoleSource>> recording_source(const ConsoleArgs& args,
                                                        ConsoleSource::Post post, PageSink& pages,
                                                        ViewerDesk& viewers);

}  // namespace handrail
